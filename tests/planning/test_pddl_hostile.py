"""Broken and unsupported PDDL: each ends in one error that names the line, and never in a wrong plan."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pix2pred.cli.app import run
from pix2pred.planning.pddl.read import PddlProblem, read_domain, read_problem
from pix2pred.planning.pddl.syntax import PddlError

DOMAIN = """(define (domain d)
 (:requirements :strips :typing)
 (:types block room - object
  red - block)
 (:constants home - room)
 (:predicates (on ?a - block ?b - block) (clear ?a - block) (at ?r - room))
 (:action stack :parameters (?x - block ?y - block)
  :precondition (and (clear ?x) (clear ?y) (not (= ?x ?y)))
  :effect (and (on ?x ?y) (not (clear ?y)))))
"""
PROBLEM = """(define (problem p) (:domain d)
 (:objects a b - block)
 (:init (clear a) (clear b))
 (:goal (and (on a b))))
"""


def says(error: PddlError, message: str) -> bool:
    """Whether ``error`` begins with ``message``, which names no column."""
    return re.sub(r"^(line \d+), column [1-9]\d*", r"\1", str(error)).startswith(message)


def read(domain: str, problem: str) -> PddlProblem:
    return read_problem(problem, read_domain(domain))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(not (clear ?y)))))", "(not (clear ?y))))", "line 1: this parenthesis is never closed"),
        ("(not (clear ?y)))))", "(not (clear ?y))))))", "line 9: a closing parenthesis too many"),
        ("?y - block)\n", "?y - blok)\n", "line 7: type blok is not declared"),
        ("red - block", "red -", "line 4: a type is missing after '-'"),
        ("red - block", "red - red", "line 4: type red is its own ancestor"),
        ("red - block", "red - block red - room", "line 4: type red is declared twice, below block and below room"),
        ("(clear ?x) (clear", "(clear ?x ?y) (clear", "line 8: clear takes 1 arguments, found 2"),
        ("(clear ?x) (clear", "(claer ?x) (clear", "line 8: predicate claer is not declared"),
        ("(clear ?x) (clear", "(cle\x00ar ?x) (clear", "line 8: cle�ar holds a character that cannot be shown"),
        (":action stack", ":action st\u202eack", "line 7: st�ack holds a character that cannot be shown"),
        ("(not (clear ?y)))))", "(not (not (clear ?y))))))", "line 9: (not ...) cannot stand here"),
        ("(clear ?x) (clear", "(clear home) (clear", "line 8: clear: a room is given where a block is due"),
        ("(clear ?x) (clear", "(clear there) (clear", "line 8: object there is not declared"),
        ("(clear ?x) (clear", "(clear ?z) (clear", "line 8: ?z is no variable here"),
        ("(= ?x ?y)", "(= ?x ?z)", "line 8: ?z is no variable here"),
        ("(= ?x ?y)", "(= ?x ?y ?x)", "line 8: (= ...) takes two terms"),
        ("(= ?x ?y)", "(= (fuel) 3)", "line 8: numeric conditions (= ...) are not supported"),
        ("(clear ?x) (clear ?y)", "(imply (clear ?x))", "line 8: (imply ...) takes two conditions"),
        ("(clear ?x) (clear ?y)", "(forall (?z - block))", "line 8: (forall ...) takes variables and one condition"),
        ("(clear ?x) (clear ?y)", "(exists (z) (clear ?x))", "line 8: z is no name of a variable"),
        ("(clear ?x) (clear ?y)", "(>= (fuel) 3)", "line 8: numeric conditions (>= ...) are not supported"),
        ("(clear ?x) (clear ?y)", "(preference p (clear ?x))", "line 8: preferences (preference ...) are not"),
        ("(and (on ?x ?y)", "(and (when (clear ?x))", "line 9: (when ...) takes a condition and an effect"),
        ("(and (on ?x ?y)", "(and (assign (fuel) 3)", "line 9: numeric effects (assign ...) are not supported"),
        ("(and (on ?x ?y)", "(and (increase (fuel) 3)", "line 9: numeric effects (increase ...) on other than"),
        ("(and (on ?x ?y)", "(and (increase (total-cost) (fuel))", "line 9: function fuel is not declared"),
        ("(and (on ?x ?y)", "(and (increase (total-cost) -1)", "line 9: costs are whole numbers from 0 to"),
        ("(and (on ?x ?y)", "(and (increase (total-cost) nan)", "line 9: costs are whole numbers from 0"),
        ("(and (on ?x ?y)", "(and (when (clear ?x) (increase (total-cost) 1))", "line 9: costs that depend on"),
        ("(and (on ?x ?y)", "(and (oneof (on ?x ?y))", "line 9: effects of chance (oneof ...) are not supported"),
        (" (:constants home - room)", " (:functions (f ?a - blok))", "line 5: type blok is not declared"),
        (" (:constants home - room)", " (:functions (f) - block)", "line 5: functions whose values are objects"),
        (" (:action", " (:derived (clear ?r) ())\n (:action", "line 8: action stack changes clear, which is derived"),
        (" (:action", " (:derived (at) ())\n (:action", "line 7: at takes 1 arguments, found 0"),
        (" (:action", " (:derived (at ?r) (not (at ?r)))\n (:action", "line 7: at is derived from its own negation"),
        ("(:action", "(:durative-action", "line 7: durative actions (:durative-action) are not supported"),
        (" (:constants home - room)", " (:predicates)", "line 6: :predicates stands here a second time"),
        ("(clear ?a - block)", "(clear ?a - block) (clear)", "line 6: predicate clear is declared twice"),
        ("(clear ?a - block)", "(clear ?a - (either block blok))", "line 6: type blok is not declared"),
        ("(clear ?a - block)", "(clear ?a - (either))", "line 6: (either ...) takes the names of types"),
        ("(clear ?a - block)", "(clear a - block)", "line 6: a is no name of a variable"),
        ("(clear ?a - block)", "(clear ?a - block) (and)", "line 6: and cannot name a predicate"),
        (" (:action", " (:action stack)\n (:action", "line 8: action stack is declared twice"),
        (":action stack", ":action", "line 7: expected a name"),
        ("?y - block)\n", "?x - block)\n", "line 7: variable ?x is declared twice"),
        (":effect", ":efect", "line 9: :efect is no part of an action"),
        (":effect", ":precondition", "line 9: :precondition stands here a second time"),
        (":effect (and (on ?x ?y) (not (clear ?y)))", ":effect", "line 9: :effect has nothing behind it"),
        ("(domain d)", "(domain)", "line 1: (domain ...) takes one name"),
        (DOMAIN, "", "line 1: the file is empty"),
        (DOMAIN, PROBLEM, "line 1: expected (define (domain NAME) ...)"),
        (DOMAIN, DOMAIN + DOMAIN, "line 10: text after the end of the definition"),
        (DOMAIN, "(" * 100_000, "line 1: parentheses are nested more than 50 deep"),
        ("red - block", "".join(f"t{i} - t{i + 1} " for i in range(3000)), "line 4: types are nested more than"),
        ("red - block", "t0 - object " + "".join(f"t{i + 1} - t{i} " for i in range(3000)), "line 4: types are nested"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_domain_is_named_with_its_line(old: str, new: str, message: str) -> None:
    assert old in DOMAIN
    with pytest.raises(PddlError) as error:
        read(DOMAIN.replace(old, new, 1), PROBLEM)
    assert says(error.value, message)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("a b - block", "a b - blok", "line 2: type blok is not declared"),
        ("a b - block", "a b a - block", "line 2: object a is declared twice"),
        ("a b - block", "a b home - block", "line 2: object home is declared twice"),
        ("a b - block", "a b - (either block blok)", "line 2: type blok is not declared"),
        ("a b - block", "a ?b - block", "line 2: ?b is no name of a object"),
        ("(clear a)", "(clear c)", "line 3: object c is not declared"),
        ("(clear a)", "(clear a b)", "line 3: clear takes 1 arguments, found 2"),
        ("(clear a)", "(clear home)", "line 3: clear: a room is given where a block is due"),
        ("(clear b)", "(not (clear a))", "line 3: clear is said to be true and not to be true"),
        ("(clear a)", "(at 5 (clear a))", "line 3: facts that become true at a time (at ...) are not supported"),
        ("(clear a)", "(= (fuel) 3)", "line 3: function fuel is not declared"),
        ("(clear a)", "clear", "line 3: expected a parenthesis, found clear"),
        ("(clear a)", "(clear (a))", "line 3: expected a name, found a parenthesis"),
        ("(on a b)", "(on ?a b)", "line 4: ?a is no variable here"),
        (" (:goal", " (:metric minimize (fuel)) (:goal", "line 4: only (:metric minimize (total-cost)) is supported"),
        (" (:goal", " (:metric maximize (total-cost)) (:goal", "line 4: only (:metric minimize (total-cost)) is"),
        (" (:goal (and (on a b)))", "", "line 1: the problem has no :goal"),
        (" (:init (clear a) (clear b))", "", "line 1: the problem has no :init"),
        (" (:domain d)", "", "line 1: the problem has no :domain"),
        ("(:domain d)", "(:domain e)", "line 1: this is a problem of the domain e, not of d"),
        (" (:goal", " (:constraints (and)) (:goal", "line 4: constraints on trajectories (:constraints) are not"),
        (" (:goal", " (:goal (on a b))\n (:goal", "line 5: :goal stands here a second time"),
        (PROBLEM, "; nothing\n", "line 2: the file is empty"),
        (PROBLEM, DOMAIN, "line 1: expected (define (problem NAME) ...)"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_problem_is_named_with_its_line(old: str, new: str, message: str) -> None:
    assert old in PROBLEM
    with pytest.raises(PddlError) as error:
        read(DOMAIN, PROBLEM.replace(old, new, 1))
    assert says(error.value, message)


@pytest.mark.parametrize(
    ("domain", "problem"),
    [
        (DOMAIN.upper(), PROBLEM),
        (DOMAIN.replace("\n", " ; (a comment\n"), PROBLEM.replace("\n", "\r\n")),
        (DOMAIN.replace("(clear ?x) (clear ?y)", "(and (and (clear ?x)) (clear ?y))"), PROBLEM),
        (
            DOMAIN.replace(":typing", ":typing :action-costs")
            .replace(" (:constants", " (:functions (total-cost) - number) (:constants")
            .replace("(and (on ?x ?y)", "(and (increase (total-cost) 1) (on ?x ?y)"),
            PROBLEM.replace("(clear b)", "(= (total-cost) 0) (clear b)").replace(
                "(:goal", "(:metric minimize (total-cost)) (:goal"
            ),
        ),
    ],
    ids=["case", "comments", "nested and", "action costs"],
)
def test_unusual_but_right(domain: str, problem: str) -> None:
    assert read(domain, problem).goal == read(DOMAIN, PROBLEM).goal
    assert read(domain, problem).initial == read(DOMAIN, PROBLEM).initial
    assert read_domain(domain).operators == read_domain(DOMAIN).operators


def test_a_problem_may_use_the_written_or_the_original_names() -> None:
    named = ";@ name predicate clear IsClear\n;@ name domain d D.0\n" + DOMAIN
    assert sorted(str(a) for a in read(named, PROBLEM).initial) == ["IsClear(a)", "IsClear(b)"]
    renamed = ";@ name predicate free IsClear\n" + PROBLEM.replace("(clear", "(free")
    assert read(named, renamed).initial == read(named, PROBLEM).initial


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe\x00(", "line 1: this is no UTF-8 text"),
        (DOMAIN.encode().replace(b"clear", "clär".encode("latin-1")), "line 6: this is no UTF-8 text"),
        (b"\x00\x01\x02", "line 1, column 1: "),
        (None, "No such file"),
        ("folder", "s a directory"),
    ],
)
@pytest.mark.parametrize("which", [0, 1])
def test_files_that_cannot_be_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes | str | None, message: str, which: int
) -> None:
    files = [tmp_path / "domain.pddl", tmp_path / "problem.pddl"]
    for path, text in zip(files, (DOMAIN, PROBLEM), strict=True):
        path.write_text(text)
    files[which].unlink()
    if isinstance(content, bytes):
        files[which].write_bytes(content)
    elif content == "folder":
        files[which].mkdir()
    assert run(["plan-pddl", *map(str, files)]) == 2
    error = capsys.readouterr().err
    assert str(files[which]) in error and message in error and "Traceback" not in error


def test_a_byte_order_mark_is_no_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "d.pddl").write_text(DOMAIN, encoding="utf-8-sig")
    (tmp_path / "p.pddl").write_text(PROBLEM, encoding="utf-8-sig")
    assert run(["plan-pddl", str(tmp_path / "d.pddl"), str(tmp_path / "p.pddl")]) == 0
    assert "(stack a b)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(clear ?y) (not", "(cleer ?y) (not", "line 8, column 34: predicate cleer is not declared"),
        ("(not (= ?x ?y))", "(> ?x ?y)", "line 8, column 44: numeric conditions"),
        ("red - block", "red -", "line 4, column 7: a type is missing after '-'"),
    ],
)
def test_errors_name_the_column(old: str, new: str, message: str) -> None:
    with pytest.raises(PddlError) as error:
        read_domain(DOMAIN.replace(old, new, 1))
    assert str(error.value).startswith(message)
