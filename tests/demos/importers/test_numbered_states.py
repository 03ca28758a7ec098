"""Projects of the method's authors: a numbered folder with one picture for each state, and the actions beside them."""

from __future__ import annotations

from pathlib import Path

import pytest

from demos.photo_files import photo
from pix2pred.demos import FolderError, check_project, read_project
from pix2pred.demos.authoring import declare, domain_text, write_drafts
from pix2pred.demos.importers import drafts_of_frames


def trajectory(folder: Path, states: int = 3, actions: str = "pick(mug, hand, [])\nplace_in(mug, box, [])\n") -> Path:
    for t in range(states):
        photo(folder / str(t) / f"shot_{40 + t}.jpg", seed=t)
    (folder / "options_traj.txt").write_text(actions)
    return folder


def test_numbered_folders_are_states(tmp_path: Path) -> None:
    for source in (trajectory(tmp_path / "data" / "traj_0"), tmp_path / "data"):
        (draft,) = drafts_of_frames(source)
        assert draft.name == "traj_0"
        assert draft.actions == ("pick(mug, hand, [])", "place_in(mug, box, [])")
        assert [sorted(state) for state in draft.states] == [["main"]] * 3


def test_ten_states_and_more_are_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    trajectory(tmp_path / "t", 12, "\n".join(["wait()"] * 11))
    (draft,) = drafts_of_frames(tmp_path)
    sizes = [state["main"].digest for state in draft.states]
    assert sizes == [drafts_digest(tmp_path / "t" / str(t)) for t in range(12)]


def drafts_digest(folder: Path) -> str:
    from pix2pred.demos.photos.copies import clean_copy

    return clean_copy(next(folder.glob("*.jpg"))).digest


@pytest.mark.parametrize("gap", ["1", "0"])
def test_folders_that_are_not_numbered_through_are_no_states(tmp_path: Path, gap: str) -> None:
    folder = trajectory(tmp_path / "t")
    (folder / gap).rename(folder / "7")
    with pytest.raises(FolderError, match="holds one photo"):
        drafts_of_frames(folder)


def test_two_pictures_in_a_numbered_folder_make_it_a_demonstration(tmp_path: Path) -> None:
    folder = trajectory(tmp_path / "t", 2)
    for t in range(2):
        photo(folder / str(t) / "second.jpg", seed=9)
    (folder / "options_traj.txt").unlink()
    assert [d.name for d in drafts_of_frames(folder)] == ["0", "1"]


def test_as_many_actions_as_steps(tmp_path: Path) -> None:
    with pytest.raises(FolderError, match=r"options_traj.txt: 1 actions need 2 pictures, .* has 3"):
        drafts_of_frames(trajectory(tmp_path / "t", 3, "pick(mug, hand, [])\n"))


@pytest.mark.parametrize(
    ("text", "low"), [("pick(mug, hand, [])", ()), ("pick(mug, hand,[ ])", ()), ("pick(mug, hand)[]", ()),
                      ("pick(mug, hand, [0.5])", (0.0,)), ("pick(mug, hand)[0.5]", (0.0,))],
)  # fmt: skip
def test_parameters_may_stand_among_the_objects(tmp_path: Path, text: str, low: tuple[float, ...]) -> None:
    bounds = "[0..1]" if low else ""
    declared = declare(
        ["cup", "hand"], ["mug:cup", "hand:hand"], [f"pick(cup, hand){bounds}"], ["Held(cup) = vlm"]
    )  # fmt: skip
    (draft,) = drafts_of_frames(trajectory(tmp_path / "t", 2, text))
    write_drafts(tmp_path / "p", [draft], domain_text("p", declared))
    demo = tmp_path / "p" / "demos" / "t" / "demo.yaml"
    demo.write_text(demo.read_text().replace("- TODO", "- Held(mug)"))
    assert check_project(tmp_path / "p") == []
    (action,) = read_project(tmp_path / "p").demos[0].actions
    assert (str(action).partition("[")[0], action.params) == ("pick(mug, hand)", (0.5,) if low else ())
