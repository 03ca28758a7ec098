"""Films of episodes (extra ``video``): every skill is seen, with its name and expected effects under it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import burger_truth
from extras import need
from pix2pred.domains.burger import BurgerDomain
from pix2pred.execution.film import Film, FilmedEpisode, FilmError
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.structs import Action, Pixels
from pix2pred.structs.environment import Step

pytestmark = need("av", extra="video")


def frames(path: Path) -> list[Pixels]:
    import av

    with av.open(str(path)) as container:
        return [np.asarray(frame.to_ndarray(format="rgb24")) for frame in container.decode(video=0)]


def test_an_episode_is_filmed_once_with_words_under_it(tmp_path: Path) -> None:
    task = BurgerDomain().tasks("more-stacks", 5, 1)[0]
    objects = {o.name: o for o in task.task.objects}
    table = burger_truth.true_table("more-stacks", {"cooked": "cooked", "hand_free": "hand_empty"})
    learned = learn_operators(table, LearningSettings(operators="cluster-and-intersect"))
    pick = next(op for op in learned if op.skill.name == "Pick")
    bound = {"robot": "robot", "patty": "patty1", "bottom_bun": "bottom_bun1", "top_bun": "patty2", "grill": "grill"}
    ground = pick.ground(tuple(objects[bound[v.type.name]] for v in pick.parameters))
    action = Action(pick.skill, (objects["robot"], objects["patty1"]))
    path = tmp_path / "films" / "episode.mp4"
    with Film(path) as film:
        filmed = FilmedEpisode(BurgerDomain().environment(task.task, task.simulator), film, "a task")
        filmed.reset()
        filmed.announce(ground, action)
        assert isinstance(filmed.execute(action), Step)
        filmed.conclude(["done"])
        filmed.reset()  # what happens after the episode, to find the cause of a failure, is not filmed
        filmed.execute(action)
    shown = frames(path)
    assert len(shown) == 8 + 8 + 15
    words = [frame[480:].astype(int).sum() for frame in (shown[2], shown[10], shown[-2])]
    assert len(set(words)) == 3 and words[1] > words[0], "the strip says something else each time"
    assert np.abs(shown[2][:480].astype(int) - shown[10][:480]).max() > 40, "the robot has moved"


def test_a_film_has_to_be_an_mp4(tmp_path: Path) -> None:
    with pytest.raises(FilmError, match="mp4"):
        Film(tmp_path / "film.gif")


def test_a_film_without_frames_leaves_no_file(tmp_path: Path) -> None:
    with Film(tmp_path / "film.mp4"):
        pass
    assert not list(tmp_path.iterdir())
