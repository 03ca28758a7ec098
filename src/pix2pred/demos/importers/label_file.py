"""Labels as the method's authors keep them: a text file of states in braces, with the actions between them.

    ===
    {*Holding(spoon): True.
    *Submerged(teabag): False.} ->
    pick(teabag, hand)[] ->
    {*Holding(spoon): True.
    *Submerged(teabag): False.}
    ===

Lines of ``===`` divide demonstrations.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.files.folders import text_of
from pix2pred.demos.files.problems import FolderError, Problem

_DIVIDER = re.compile(r"^={3,}[ \t\r]*$", re.MULTILINE)
_STEP = re.compile(r"\{([^{}]*)\}|->|[^\s{}][^\n{}]*?(?=\s*->|\n|\Z)")
_LABEL = re.compile(r"[*\s]*([^\s:*][^:\n]*\))\s*:\s*(\w+)\.?\s*\Z")
_VALUES = {"true": True, "false": False}


@dataclass(frozen=True, slots=True)
class LabelledTrajectory:
    """The true atoms of every state, as written, and the action after each but the last; ``line`` is its first."""

    line: int
    states: tuple[tuple[str, ...], ...]
    actions: tuple[str, ...]


def read_labels(file: Path) -> tuple[LabelledTrajectory, ...]:
    """The labelled demonstrations in ``file``. Raises ``FolderError`` with every line that is wrong."""
    text = text_of(file)
    found: list[Problem] = []
    read: list[LabelledTrajectory] = []
    start = 0
    for end in (*(match.start() for match in _DIVIDER.finditer(text)), len(text)):
        block = text[start:end]
        if _DIVIDER.sub("", block).strip():
            read.append(_trajectory(file, block, text.count("\n", 0, start) + 1, found))
        start = end
    if not read and not found:
        found.append(Problem(file, None, "holds no labels: states {*Word(object): True} with '-> action ->' between"))
    if found:
        raise FolderError(found)
    return tuple(read)


def _trajectory(file: Path, block: str, first: int, found: list[Problem]) -> LabelledTrajectory:
    states: list[tuple[str, ...]] = []
    actions: list[str] = []
    block = _DIVIDER.sub("", block)
    for step in _STEP.finditer(block):
        line = first + block.count("\n", 0, step.start())
        if step[1] is not None:
            states.append(_true_atoms(file, step[1], line, found))
        elif step[0] != "->":
            actions.append(step[0].strip())
        if not len(actions) <= len(states) <= len(actions) + 1:
            found.append(Problem(file, line, "states in braces and actions have to follow each other in turn"))
            break
    if len(states) != len(actions) + 1 and not found:
        found.append(
            Problem(file, first, f"{len(actions)} actions need {len(actions) + 1} states, found {len(states)}")
        )
    return LabelledTrajectory(first, tuple(states), tuple(actions))


def _true_atoms(file: Path, body: str, first: int, found: list[Problem]) -> tuple[str, ...]:
    atoms = []
    for number, line in enumerate(body.splitlines(), start=first):
        if not line.strip():
            continue
        label = _LABEL.match(line)
        value = _VALUES.get(label[2].lower()) if label else None
        if label is None or value is None:
            found.append(
                Problem(file, number, f"expected a label such as '*On(cup, tray): True', found {line.strip()!r}")
            )
        elif value:
            atoms.append(label[1].strip())
    return tuple(atoms)


def with_labels(file: Path, drafts: Sequence[Draft]) -> tuple[Draft, ...]:
    """``drafts`` with the labels of ``file`` as given atoms, demonstration by demonstration in order.

    Raises ``FolderError`` when they are not about the same steps.
    """
    trajectories = read_labels(file)
    found = []
    if len(trajectories) != len(drafts):
        message = (
            f"labels {len(trajectories)} demonstrations, there are {len(drafts)}: {', '.join(d.name for d in drafts)}"
        )
        raise FolderError.about(file, message)
    labelled = []
    for draft, one in zip(drafts, trajectories, strict=True):
        if len(draft.actions) != len(one.actions):
            message = f"labels {len(one.actions)} actions, {draft.name} has {len(draft.actions)}"
            found.append(Problem(file, one.line, message))
        elif any(told and _bare(told) != _bare(said) for told, said in zip(draft.actions, one.actions, strict=True)):
            pairs = zip(draft.actions, one.actions, strict=True)
            told, said = next((t, s) for t, s in pairs if t and _bare(t) != _bare(s))
            found.append(Problem(file, one.line, f"labels the action {said!r}, where {draft.name} has {told!r}"))
        actions = tuple(told or said for told, said in zip(draft.actions, one.actions, strict=False))
        labelled.append(replace(draft, actions=actions, given=one.states))
    if found:
        raise FolderError(found)
    return tuple(labelled)


def _bare(action: str) -> str:
    """An action without its parameters and spaces: ``pick(mug, hand, [])`` and ``pick(mug, hand)[]`` are one."""
    return re.sub(r",?\[[^\[\]]*\]|\s", "", action.replace(" ", ""))
