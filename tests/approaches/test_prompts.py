"""The prompts of the rivals, word for word: a change of a prompt or of how it is filled shows here as a difference.

After an intended change run ``PIX2PRED_SNAPSHOTS=write pytest tests/approaches/test_prompts.py`` and read the diff.
"""

from __future__ import annotations

import os
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest

from pix2pred.approaches.approach import Training
from pix2pred.approaches.vila import ViLa
from pix2pred.approaches.vlm_feature_predicates import code_request
from pix2pred.pipeline import LearningProblem
from pix2pred.registry import load_planner
from pix2pred.settings import Settings
from pix2pred.structs import Action, Object, Skill, State, Task, Type, Vocabulary
from pix2pred.structs.goals.opposites import contrary
from pix2pred.vlm import Request
from predicates import scripted
from predicates.scripted import HOLDING, P1, R, ScriptedVLM, demo

SNAPSHOTS = Path(__file__).parents[1] / "data" / "prompts" / "baselines"
PROMPTS = files("pix2pred.approaches") / "prompts"
FILES = ("code", "vila_example", "vila_pure")
CUP = Type("tall_cup", ("x", "height"), scripted.CUP)
PUSH = Skill("Push", (scripted.ROBOT, CUP), (-1.0, 0.0), (1.0, 3.14159))
VOCABULARY = Vocabulary("kitchen", (*scripted.TYPES, CUP), (scripted.PICK, PUSH), (HOLDING,))


def check(name: str, text: str) -> None:
    path = SNAPSHOTS / f"{name}.txt"
    if os.environ.get("PIX2PRED_SNAPSHOTS") == "write":
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    assert text.splitlines() == path.read_text(encoding="utf-8").splitlines()


def shown(request: Request) -> str:
    parts = [p if isinstance(p, str) else f"[picture: {p.heading}]" for p in request.parts]
    return f"purpose {request.purpose}, at most {request.max_tokens} tokens\n\n" + "\n".join(parts) + "\n"


def test_every_prompt_is_checked() -> None:
    assert sorted(p.name for p in PROMPTS.iterdir()) == sorted(f"{name}.txt" for name in FILES)


@pytest.mark.parametrize("name", FILES)
def test_prompt_file(name: str) -> None:
    check(name, (PROMPTS / f"{name}.txt").read_text(encoding="utf-8"))


@pytest.mark.parametrize("few_shot", [False, True])
def test_filled_plan_prompts(few_shot: bool) -> None:
    demos = (demo(actions=1), demo(actions=1, cameras=("left", "right")), demo(name="not shown"))
    problem = LearningProblem(VOCABULARY, demos, ScriptedVLM([]), Settings())
    training = Training(problem, load_planner("portfolio"), shown_demos=2)
    task = Task("t", (*scripted.OBJECTS, Object("c2", CUP)), scripted.state(9, cameras=("a", "b")), (HOLDING(R, P1),))
    agent = ViLa("vila", shows_demos=few_shot).train(training)
    check("filled_vila_fewshot" if few_shot else "filled_vila_pure", shown(agent.request(task)))


def test_what_skills_and_goals_mean_is_said_outside_the_published_protocol() -> None:
    pour = replace(PUSH, description="Moves the cup until it is in reach.")
    holding = replace(HOLDING, description="The robot has the plate in its hand.")
    vocabulary = replace(VOCABULARY, skills=(pour,))
    texts = []
    for protocol in ("published", "frugal"):
        settings = Settings.model_validate({"labels": {"protocol": protocol}})
        problem = LearningProblem(vocabulary, (demo(actions=1),), ScriptedVLM([]), settings)
        agent = ViLa("vila", shows_demos=False).train(Training(problem, load_planner("portfolio"), shown_demos=0))
        texts.append(agent.request(Task("t", scripted.OBJECTS, scripted.state(9), (holding(R, P1),))).text)
    published, told = texts
    assert "in reach" not in published and "in its hand" not in published
    assert "]: Moves the cup until it is in reach." in told and ": The robot has the plate in its hand." in told
    assert "\n\nWhat this means:\n- Holding(" in told
    silent = agent.request(Task("t", scripted.OBJECTS, scripted.state(9), (HOLDING(R, P1),))).text
    assert "What this means" not in silent, "a goal of which nothing is said"


def test_every_way_to_reach_a_goal_is_told() -> None:
    problem = LearningProblem(VOCABULARY, (demo(actions=1),), ScriptedVLM([]), Settings())
    agent = ViLa("vila", shows_demos=False).train(Training(problem, load_planner("portfolio"), shown_demos=0))
    p2 = next(o for o in scripted.OBJECTS if o not in (R, P1) and o.type == P1.type)
    ways = ((HOLDING(R, P1),), (contrary(HOLDING(R, P1)), HOLDING(R, p2)))
    text = agent.request(Task("t", scripted.OBJECTS, scripted.state(9), ways[0], ways[1:])).text
    one, other = (f"Holding({R.prompt_name}, {o.prompt_name})" for o in (P1, p2))
    assert f"\n({one}) or (not {one} and {other})\n" in text


def test_code_is_told_what_types_features_and_skills_mean_outside_the_published_protocol() -> None:
    cup = replace(CUP, description="A vessel.", measures="height in metres.")
    push = replace(PUSH, description="Moves the cup until it is in reach.")
    vocabulary = replace(VOCABULARY, types=(*scripted.TYPES, cup), skills=(push,))
    published, told = (
        code_request(demo(actions=1), vocabulary, marks=True, explained=explained).text for explained in (False, True)
    )
    for said in ("A vessel.", "height in metres.", "until it is in reach."):
        assert said not in published and said in told
    assert "arrow" in published and "arrow" not in told and told.count("dash") == 1, "the lines of types have dashes"
    bare = code_request(demo(actions=1), replace(vocabulary, initial=()), marks=True, explained=True).text
    assert "Known already" in told and "Known already" not in bare


def test_filled_code_prompt() -> None:
    tall = Object("c2", CUP, "tall cup")
    states = tuple(State(scripted.state(t).pictures, {tall: (0.5 * t, 12.0)}) for t in range(2))
    one = demo(actions=1)
    shown_demo = type(one)("d", (*one.objects, tall), states, (Action(PUSH, (R, tall), (0.5, 1.0)),), one.goal)
    check("filled_code", shown(code_request(shown_demo, VOCABULARY, marks=True)))
