"""Broken and unsupported PDDL: each ends in one error that names the line, and never in a wrong plan."""

from __future__ import annotations

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


def read(domain: str, problem: str) -> PddlProblem:
    return read_problem(problem, read_domain(domain))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(not (clear ?y)))))", "(not (clear ?y))))", "line 1: this parenthesis is never closed"),
        ("(not (clear ?y)))))", "(not (clear ?y))))))", "line 9: a closing parenthesis too many"),
        ("?y - block)\n", "?y - blok)\n", "line 7: type blok is not declared"),
        ("red - block", "red - blok", "line 4: type blok is not declared"),
        ("red - block", "red -", "line 4: a type is missing after '-'"),
        ("red - block", "red - red", "line 4: type red is its own ancestor"),
        ("red - block", "red - block red - room", "line 4: type red is declared twice"),
        ("(clear ?x) (clear", "(clear ?x ?y) (clear", "line 8: clear takes 1 arguments, found 2"),
        ("(clear ?x) (clear", "(claer ?x) (clear", "line 8: predicate claer is not declared"),
        ("(clear ?x) (clear", "(cle\x00ar ?x) (clear", "line 8: predicate cle�ar is not declared"),
        ("(clear ?x) (clear", "(at home) (clear", "line 8: home: constants in actions are not supported"),
        ("(clear ?x) (clear", "(clear ?z) (clear", "line 8: ?z: is no parameter"),
        ("(= ?x ?y)", "(= ?x ?z)", "line 8: ?z: is no parameter"),
        ("(= ?x ?y)", "(= ?x home)", "line 8: home: constants in actions are not supported"),
        ("(= ?x ?y)", "(= ?x ?x)", "line 8: (not (= ...)) takes two different parameters"),
        ("(= ?x ?y)", "(= ?x ?y ?x)", "line 8: (not (= ...)) takes two different parameters"),
        ("(= ?x ?y)", "(on ?x ?y)", "line 8: negative preconditions other than (not (= ?a ?b))"),
        ("(not (= ?x ?y))", "(= ?x ?y)", "line 8: equalities other than (not (= ?a ?b))"),
        ("(clear ?x) (clear ?y)", "(or (clear ?x))", "line 8: disjunctions (or ...)"),
        ("(clear ?x) (clear ?y)", "(imply (clear ?x) (clear ?y))", "line 8: implications"),
        ("(clear ?x) (clear ?y)", "(forall (?z - block) (clear ?z))", "line 8: quantifiers"),
        ("(clear ?x) (clear ?y)", "(>= (fuel) 3)", "line 8: numeric conditions"),
        ("(and (on ?x ?y)", "(and (when (clear ?x) (on ?x ?y))", "line 9: conditional effects"),
        ("(and (on ?x ?y)", "(and (assign (fuel) 3)", "line 9: numeric effects"),
        ("(and (on ?x ?y)", "(and (increase (fuel) 3)", "line 9: numeric effects"),
        (":typing", ":adl", "line 2: requirement :adl is not supported"),
        (":typing", ":typing :fluents", "line 2: requirement :fluents is not supported"),
        (" (:constants home - room)", " (:functions (fuel))", "line 5: numeric fluents other than (total-cost)"),
        (" (:constants home - room)", " (:derived (at ?r) ())", "line 5: :derived is no section of a domain"),
        ("(:action", "(:durative-action", "line 7: :durative-action is no section of a domain"),
        (" (:constants home - room)", " (:predicates)", "line 6: :predicates stands here a second time"),
        ("(clear ?a - block)", "(clear ?a - block) (clear)", "line 6: predicate clear is declared twice"),
        ("(clear ?a - block)", "(clear ?a - (either block room))", "line 6: (either ...) is not supported"),
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
    assert str(error.value).startswith(message)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("a b - block", "a b - blok", "line 2: type blok is not declared"),
        ("a b - block", "a b a - block", "line 2: object a is declared twice"),
        ("a b - block", "a b home - block", "line 2: object home is declared twice"),
        ("a b - block", "a b - (either block room)", "line 2: (either ...) is not supported"),
        ("a b - block", "a ?b - block", "line 2: ?b is no name of a object"),
        ("(clear a)", "(clear c)", "line 3: object c is not declared"),
        ("(clear a)", "(clear a b)", "line 3: clear takes 1 arguments, found 2"),
        ("(clear a)", "(clear home)", "line 3: clear: a room is given where a block is due"),
        ("(clear a)", "(not (clear a))", "line 3: negative facts are not supported"),
        ("(clear a)", "(= (fuel) 3)", "line 3: numeric fluents other than (total-cost)"),
        ("(clear a)", "clear", "line 3: expected a parenthesis, found clear"),
        ("(clear a)", "(clear (a))", "line 3: expected a name, found a parenthesis"),
        ("(on a b)", "(not (on a b))", "line 4: negative goals are not supported"),
        ("(on a b)", "(or (on a b))", "line 4: disjunctions"),
        ("(on a b)", "(on ?a b)", "line 4: object ?a is not declared"),
        (" (:goal (and (on a b)))", "", "line 1: the problem has no :goal"),
        (" (:init (clear a) (clear b))", "", "line 1: the problem has no :init"),
        (" (:domain d)", "", "line 1: the problem has no :domain"),
        ("(:domain d)", "(:domain e)", "line 1: this is a problem of the domain e, not of d"),
        (" (:goal", " (:constraints (and)) (:goal", "line 4: :constraints is no section of a problem"),
        (" (:goal", " (:goal (on a b))\n (:goal", "line 5: :goal stands here a second time"),
        (PROBLEM, "; nothing\n", "line 2: the file is empty"),
        (PROBLEM, DOMAIN, "line 1: expected (define (problem NAME) ...)"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_problem_is_named_with_its_line(old: str, new: str, message: str) -> None:
    assert old in PROBLEM
    with pytest.raises(PddlError) as error:
        read(DOMAIN, PROBLEM.replace(old, new, 1))
    assert str(error.value).startswith(message)


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
        (b"\x00\x01\x02", "line 1: "),
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
