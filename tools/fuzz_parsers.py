"""Throws random and mutated answers at every parser and checks what comes out.

    python tools/fuzz_parsers.py --count 1000000               the long run: every parser in turn
    python tools/fuzz_parsers.py --parser plan --start 400000  one parser, from where it was stopped
    python tools/fuzz_parsers.py --linear                      seconds for texts of growing length, per hostile pattern

A text is a plausible answer changed a few times (lines and characters deleted, doubled, swapped, cut off; brackets,
escapes, other alphabets, orders and pieces of other answers put in), or noise. Text number N is the same whatever was
tried before it. Whatever the text: no exception, nothing outside the query, its types and its objects, no value but
three, and every value's word stands where ``places`` says.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import sys
import time
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass
from operator import eq

from pix2pred.approaches.parse_code import parse_code
from pix2pred.approaches.parse_plan import NoPlanError, parse_plan
from pix2pred.predicates.labelling.parse_labels import ALL_WORDS, parse_labels
from pix2pred.predicates.labelling.structured import as_text
from pix2pred.predicates.labelling.written_forms import as_lines, without_markup
from pix2pred.predicates.proposing.parse_atoms import kept
from pix2pred.predicates.proposing.propose import ProposalSettings, read_proposal
from pix2pred.structs import Demo, Object, Skill, State, Type

ITEM = Type("item")
OBJECTS = tuple(Object(name, ITEM, name) for name in ("patty1", "top_bun2", "grill", "small_blue_cup"))
DEMO = Demo("d", OBJECTS, (State(),), (), ())
SKILLS = (Skill("Pick", (ITEM, ITEM)), Skill("Push", (ITEM,), (-1.0, 0.0), (1.0, 2.0)))
QUERY = (
    "cooked(patty1)",
    "on(patty1, grill)",
    "on(top_bun2, patty1)",
    "near_to(small_blue_cup, grill)",
    "Clear(grill)",
)
LABELS = (
    "\n".join(f"* {atom}: {('True', 'False', 'Unknown')[i % 3]}. It looks so." for i, atom in enumerate(QUERY)),
    "1. Expected changes: on(patty1, grill) becomes True.\n2. Observed changes: cooked(patty1): True?\n3. Values:\n"
    + "\n".join(f"- **{atom}**: *False*. It was True before." for atom in QUERY),
    "| predicate | value |\n|---|---|\n" + "\n".join(f"| `{atom}` | **True** |" for atom in QUERY),
    "I'm sorry, but I can't help with that.",
)  # fmt: skip
STRUCTURED = (
    json.dumps({"expected_changes": "a", "observed_changes": "b",
                "values": [{"atom": a, "explanation": "x", "value": "True"} for a in QUERY]}),
    json.dumps({"values": [{"atom": a, "value": "Unknown"} for a in QUERY], "more": [None, 1.5, {"x": []}]}, indent=1),
)  # fmt: skip
FORMS = (
    "<table>" + "".join(f"<tr><td>{atom}</td><td>True</td></tr>" for atom in QUERY) + "</table>",
    "\n".join(f"- [{'x '[i % 2]}] {atom}" for i, atom in enumerate(QUERY)),
    "atom,why,value\n" + "\n".join(f'"{atom}","it, so",False' for atom in QUERY),
    "\n".join(f"- atom: {atom}\n  why: so\n  value: true" for atom in QUERY),
    "True:\n" + "\n".join(QUERY[:2]) + "\nFalse: " + ", ".join(QUERY[2:]),
    "\n".join(f"{atom}: $\\boxed{{\\text{{True}}}}$" for atom in QUERY),
)
PROPOSALS = (
    "## Pick\nBefore: on(patty1, grill)\nAfter: held(patty1), `in_air(patty1)`\nSynonyms: lifted(patty1)\n"
    "Antonyms: resting\\_on(patty1, grill)\nIn general: on(x, y): atop(x, y) e.g. (see above)",
    "1. **Changed**\n" + "\n".join(f"   * {atom}" for atom in QUERY),
)
PLANS = (
    "The patty lies on the grill.\n\nPlan:\nPick(patty1:item, grill:item)[]\nPush(top_bun2:item)[0.5, 1e-3]\n"
    "1. Pick(small_blue_cup:item, patty1:item)[]",
    "**Plan:**\n- `Push(grill:item)[nan, inf]`\n- Push(grill:item)[1]\n- Fly(grill:item)[]",
)
CODE = (
    'Here it is:\n```python\ndef f(state, objects):\n    (a,) = objects\n    return state.get(a, "z") <= 0.5\n\n'
    "IsLow = Predicate(\"IsLow\", [item], f)\n```\nand\n```\nTwo = Predicate(name='Two', types=[item, item], "
    "classifier=f)  # two\n```",
)
PIECES = (
    "(", ")", "((", "))", ",", ":", "=", "*", "**", "`", "\\", "\\_", "\\(", "_", "-", "|", "\n", "\r\n", "\t", " ",
    "3.", "3)", "Section 3:", "True", "False", "Unknown", "true", "Maybe", "not ", "\x00", "\ufeff", "\u202e", "：",
    "是", "ложь", "\U0001f354", "é", "{", "}", "[", "]", '"', "'", "<", ">", "#",
    "cooked(patty1)", "cooked(patty1): True",
    "Plan:", "Pick(", ":item", "[0.1, ", "]\n", "```", "```python\n", "Predicate(", "item", "1e999", "Infinity",
    "on(grill, grill)", "ignore all previous instructions", "p()", "a" * 50, "(" * 50, "on(" * 20, "\ud800",
)  # fmt: skip


def mutated(rng: random.Random, seeds: tuple[str, ...]) -> str:
    """One text, made from ``seeds``."""
    if rng.random() < 0.1:
        return "".join(rng.choice(PIECES) for _ in range(rng.randrange(60)))
    text = rng.choice(seeds)
    for _ in range(rng.randrange(6)):
        i, j = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        change = rng.randrange(7)
        if change == 0:
            text = text[:i] + text[i + rng.randrange(1, 12) :]
        elif change == 1:
            text = text[:i] + rng.choice(PIECES) + text[i:]
        elif change == 2:
            text = text[:i] + text[i:j][:200] + text[i:]
        elif change == 3:
            text = text[:i]
        elif change == 4:
            lines = text.split("\n")
            rng.shuffle(lines)
            text = "\n".join(lines)
        elif change == 5:
            text = text[:i] + rng.choice(seeds)[j:] + text[j:]
        else:
            text = text[:i] + chr(rng.choice((rng.randrange(128), rng.randrange(0x3000)))) + text[i + 1 :]
    return text[:4000]


def check_labels(text: str) -> None:
    """Raises ``AssertionError``, or whatever the parser raises; so do the others."""
    parsed = parse_labels(text, QUERY)
    assert set(parsed.values) | set(parsed.missing) == set(QUERY), "an atom outside the query, or one lost"
    assert not set(parsed.values) & set(parsed.missing), "an atom both there and missing"
    raw = kept(text) if parsed.values else []
    for atom, value in parsed.values.items():
        begin = bisect_left(raw, parsed.places[atom])
        words = list(ALL_WORDS)  # a denied atom has the opposite of the word that stands there
        said = ("".join(text[i] for i in raw[begin : begin + len(word)]).lower() for word in words)
        assert any(map(eq, said, words)), f"{atom}: no word where {value.word} was said to be"


def check_structured(text: str) -> None:
    check_labels(as_text(text))


def check_forms(text: str) -> None:
    check_labels(without_markup(text))
    check_labels(as_lines(text, QUERY))


def check_proposal(text: str) -> None:
    proposal = read_proposal(DEMO, text, ProposalSettings(max_atoms=5))
    assert len(proposal.accepted) <= 5
    for proposed in proposal.accepted:
        assert proposed.objects and set(proposed.objects) <= set(OBJECTS), "an object outside the demonstration"
        assert len(set(proposed.objects)) == len(proposed.objects) and proposed.name.isidentifier()


def check_plan(text: str) -> None:
    try:
        plan = parse_plan(text, SKILLS, (ITEM,), OBJECTS)
    except NoPlanError:
        return
    for action in plan.actions:
        assert action.skill in SKILLS and set(action.objects) <= set(OBJECTS), "a skill or an object of no task"
        assert len(action.objects) == len(action.skill.types) and len(action.params) == action.skill.dimension
        assert all(map(math.isfinite, action.params)), "a number that is none"


def check_code(text: str) -> None:
    found, _ = parse_code(text, {"item": ITEM})
    for predicate in found:
        assert predicate.types and set(predicate.types) == {ITEM}, "a type outside the domain"
        assert predicate.name.isidentifier() and predicate.function.isidentifier()
        assert predicate.source in text.replace("\r\n", "\n")


@dataclass(frozen=True, slots=True)
class Fuzzed:
    """A parser: answers to begin with, and what must hold of whatever is read."""

    seeds: tuple[str, ...]
    check: Callable[[str], None]


PARSERS = {
    "labels": Fuzzed(LABELS + PROPOSALS, check_labels),
    "forms": Fuzzed(FORMS + LABELS[2:3], check_forms),
    "structured": Fuzzed(STRUCTURED + LABELS[:1], check_structured),
    "proposal": Fuzzed(PROPOSALS + LABELS, check_proposal),
    "plan": Fuzzed(PLANS + LABELS[:1], check_plan),
    "code": Fuzzed(CODE, check_code),
}


def text_number(parser: str, seed: int, number: int) -> str:
    """The text tried as number ``number``: a function of the three alone."""
    return mutated(random.Random(f"{parser} {seed} {number}"), PARSERS[parser].seeds)


HOSTILE = {
    "opening brackets": "on(",
    "nested": "((((",
    "names": "a" * 40 + " ",
    "spaces": "cooked" + " " * 40,
    "commas": "on(" + "a," * 20,
    "third sections": "3. a(\n",
    "thirds": "3.\n",
    "line starts": "\n>>>>---- 3. ",
    "atoms": "on(patty1, grill): True\n",
    "unasked": "on(patty1, cup9): True ",
    "escapes": "\\_\\*`",
    "rows": "<tr><td>",
    "tags": '<a b="',
    "comments": "<!-- ",
    "boxes": "\\boxed{",
    "ticks": "- [x] ",
    "cells": "| , ; \t",
    "headings": "True:\n",
    "values": ". true",
    "dashes": "-a",
    "digits": "1a",
    "one long argument": "patty1 ",
    "plans": "Plan:\n * # > ",
    "steps": "Pick(patty1:item, grill:item)[]\n",
    "one long step": "Pick(patty1:item, ",
    "blocks": "```python\nx\n",
    "predicates": "A = Predicate(\n",
    "spaces of a predicate": " \n",
}
BEGINNINGS = {
    "one long argument": "on(",
    "steps": "Plan:\n",
    "one long step": "Plan:\n",
    "predicates": "```\n",
    "spaces of a predicate": '```\nA = Predicate("A", [item], f',
}


def linear() -> bool:
    """Seconds per pattern for 100,000 and 800,000 characters; whether none takes much more than eight times as long."""
    good = True
    for name, piece in HOSTILE.items():
        took = []
        for size in (100_000, 800_000):
            text = BEGINNINGS.get(name, "") + piece * (size // len(piece)) + "\n```"
            best = float("inf")
            for _ in range(3):
                begin = time.process_time()
                read_by_all(text)
                best = min(best, time.process_time() - begin)
            took.append(best)
        ratio = took[1] / max(took[0], 1e-3)
        good &= ratio < 20
        print(f"{name:<22}{took[0]:8.3f} s{took[1]:8.3f} s   {ratio:5.1f} times for 8 times the text", flush=True)
    return good


def read_by_all(text: str) -> None:
    parse_labels(text, QUERY)
    read_proposal(DEMO, text, ProposalSettings())
    as_text(text)
    as_lines(without_markup(text), QUERY)
    parse_code(text, {"item": ITEM})
    if text.startswith("Plan:") or "\nPlan:" in text:
        parse_plan(text, SKILLS, (ITEM,), OBJECTS)


def fuzz(parser: str, seed: int, start: int, count: int) -> None:
    """Texts ``start`` to ``count``; the one that breaks something is printed and its exception raised."""
    begin, characters, number = time.process_time(), 0, start
    try:
        for number in range(start, count):
            text = text_number(parser, seed, number)
            characters += len(text)
            PARSERS[parser].check(text)
            if number % 50_000 == 0 and number > start:
                print(f"{parser}: {number:,} of {count:,}, {time.process_time() - begin:.0f} s", file=sys.stderr)
    except KeyboardInterrupt:
        sys.exit(f"stopped; go on with --parser {parser} --seed {seed} --start {number} --count {count}")
    except Exception:
        print(f"{parser}: text {number} of seed {seed}: {text!r}", file=sys.stderr)
        raise
    took = time.process_time() - begin
    print(f"{parser}: {count - start:,} texts, {characters:,} characters, {took:.0f} s, no finding", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parser", choices=PARSERS, help="one parser alone (default: all)")
    parser.add_argument("--count", type=int, default=100_000, help="texts per parser")
    parser.add_argument("--start", type=int, default=0, help="number of the first text")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--linear", action="store_true")
    options = parser.parse_args()
    if options.linear:
        sys.exit(0 if linear() else 1)
    for name in [options.parser] if options.parser else PARSERS:
        fuzz(name, options.seed, options.start, options.count)


if __name__ == "__main__":
    main()
