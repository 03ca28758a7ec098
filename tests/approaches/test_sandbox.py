"""Hostile programs: the language refuses them, the confined process survives nothing else, and we always get on."""

from __future__ import annotations

import json
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from approaches.hostile import LANGUAGE, RIGHTS, classifier
from pix2pred.approaches.sandbox import CodeError, SandboxLimits, run_classifier
from pix2pred.approaches.sandbox.process import CHILD
from pix2pred.structs import Object, Type

ITEM = Type("item", ("row", "z"))
PATTY = Type("patty", ("row", "z"), ITEM)
P1, P2 = Object("p1", PATTY, "patty1"), Object("p2", PATTY, "patty2")
SCENES = [{P1: (1.0, 0.0), P2: (2.0, 1.0)}, {P1: (3.0, 1.0), P2: (2.0, 0.0)}]
QUERIES = [(0, (P1,)), (0, (P2,)), (1, (P1,)), (1, (P2,))]
TIGHT = SandboxLimits(steps=200_000, megabytes=256, cpu_seconds=3, wall_seconds=60)


def ask(source: str, limits: SandboxLimits = TIGHT) -> tuple[bool, ...]:
    return run_classifier(source, "f", ["item", "patty"], SCENES, QUERIES, limits)


def test_a_classifier_reads_features() -> None:
    assert ask(classifier("(thing,) = objects\nreturn state.get(thing, 'z') > 0.5")) == (False, True, True, False)


def test_a_classifier_may_use_loops_functions_annotations_and_math() -> None:
    source = textwrap.dedent("""
        def distance(a: float, b: float) -> float:
            return math.sqrt((a - b) ** 2)

        def f(state: State, objects: list[str]) -> bool:
            nearest = min(distance(state.get(o, "row"), state.get(objects[0], "row"))
                          for o in state.objects("item") if o != objects[0])
            total = 0
            for o in sorted(set(state.objects("patty"))):
                total += state.get(o, "z")
            return nearest <= 1 and total == 1

        P = Predicate("P", [patty], f)
    """)
    assert ask(source) == (True, True, True, True)


def test_objects_are_called_as_in_the_prompt() -> None:
    assert ask(classifier("return objects[0] == 'patty1'")) == (True, False, True, False)


@pytest.mark.parametrize("name", LANGUAGE)
def test_the_language_has_no_way_out(name: str) -> None:
    with pytest.raises(CodeError) as caught:
        ask(LANGUAGE[name])
    assert str(caught.value) and len(str(caught.value)) <= 400


def test_at_least_forty_programs_are_tried_at_each_wall_together() -> None:
    assert len(LANGUAGE) >= 40 and len(LANGUAGE) + len(RIGHTS) >= 80


WITHOUT_LANGUAGE = """
import importlib.util, sys
spec = importlib.util.spec_from_file_location("confine", sys.argv[1])
rights = importlib.util.module_from_spec(spec)
spec.loader.exec_module(rights)
import _thread, ctypes, mmap, os, resource, signal, socket, subprocess, time
from multiprocessing import shared_memory
rights.confine(512, 2)
os.write(1, b"confined ")
try:
    exec(sys.argv[2], {})
except BaseException as error:
    os.write(1, f"stopped {type(error).__name__}".encode())
    os._exit(3)
os.write(1, b"escaped")
os._exit(0)
"""


@pytest.mark.parametrize("name", RIGHTS)
def test_a_confined_process_can_do_nothing_whatever_it_runs(name: str, tmp_path: Path) -> None:
    command = [sys.executable, "-B", "-c", WITHOUT_LANGUAGE, str(CHILD.with_name("confine.py")), RIGHTS[name]]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        assert process.stdout is not None
        said = process.stdout.read(100_000)
        process.kill() if len(said) == 100_000 else None
        code = process.wait(timeout=120)
    assert said.startswith(b"confined ")
    assert b"escaped" not in said
    assert code != 0
    assert not Path("/tmp/escaped").exists()


@settings(max_examples=15, deadline=None)
@given(st.text(max_size=200))
def test_any_text_is_refused_or_fails_without_harm(text: str) -> None:
    with pytest.raises(CodeError):
        ask(text)


def test_a_program_that_dies_is_an_error_and_not_a_value(tmp_path: Path) -> None:
    for script, message in (
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "SIGKILL"),
        ("import os; os.write(1, b'V01')", "no usable answer"),
        ("import os; os.write(1, b'V' + b'1' * 5000)", "wrote more than"),
        ("import os; os.write(1, b'Vxyzz')", "no usable answer"),
        ("pass", "no usable answer"),
        ("import time; time.sleep(60)", "SIGKILL"),
    ):
        fake = tmp_path / "child.py"
        fake.write_text(script)
        limits = SandboxLimits(wall_seconds=3 if "sleep" in script else 120)
        with pytest.raises(CodeError, match=message):
            run_classifier("f = 1", "f", ["item"], SCENES, QUERIES, limits, fake)


def test_the_process_starts_with_an_empty_environment_and_no_packages(tmp_path: Path) -> None:
    """The command line of the sandbox, with a child that tells what it has."""
    fake = tmp_path / "child.py"
    fake.write_text("import os, sys, json; print(json.dumps([sorted(os.environ), 'site' in sys.modules, sys.path]))")
    done = subprocess.run(
        [sys.executable, "-P", "-s", "-S", "-B", str(fake)],
        env={"PYTHONHASHSEED": "0"}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    names, has_site, path = json.loads(done.stdout)
    assert set(names) <= {"PYTHONHASHSEED", "LC_CTYPE"} and not has_site
    assert not any("site-packages" in p or str(tmp_path) in p for p in path)


def test_sets_are_ordered_alike_in_every_process() -> None:
    source = classifier("return [x for x in {'a', 'b', 'c', 'd', 'e'}][0] == 'a'")
    assert len({ask(source) for _ in range(3)}) == 1


ADDRESSES = {
    "text of a function": "return len(str(f)) % 2 == 0",
    "text of an object": "return str(state)[-2] > '5'",
    "text of a list that holds one": "return str([state])[-3] > '5'",
    "text of a method": "return str(state.get)[-3] > '5'",
    "text of a type": "return str(str)[-3] > '5'",
    "formatted": "return ('%s' % f)[-2] > '5'",
    "formatted by a name": "text = '%s'\nreturn (text % (f,))[-2] > '5'",
    "formatted in place": "text = '%s'\ntext %= f\nreturn text[-2] > '5'",
}


@pytest.mark.parametrize("body", ADDRESSES.values(), ids=ADDRESSES)
def test_no_value_can_come_from_an_address_in_memory(body: str) -> None:
    with pytest.raises(CodeError, match=r"is not allowed|cannot be formatted"):
        ask(classifier(body))


def test_sets_of_things_that_are_hashed_by_their_address_keep_their_order() -> None:
    many = ", ".join(["lambda: 0"] * 30)
    body = f"numbered = [{many}]\nshuffled = list(set(numbered[::-1]))\nreturn shuffled == numbered[::-1]"
    assert ask(classifier(body)) == (True,) * 4


def test_sets_text_and_remainders_work_as_ever() -> None:
    body = (
        "both = {1, 2} | set([3])\nboth.add(4)\ncount = 7\ncount %= 4\n"
        "return len({x % 2 for x in both}) == 2 and 3 in both and {1} <= both and str(1.5) == '1.5' and count == 3"
    )
    assert ask(classifier(body)) == (True,) * 4
