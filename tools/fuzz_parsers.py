"""Throws random and mutated answers at every parser and checks what comes out.

    python tools/fuzz_parsers.py --count 1000000      the long run: seconds, texts, findings
    python tools/fuzz_parsers.py --linear             seconds for texts of growing length, per hostile pattern

A text is a plausible answer changed a few times (lines and characters deleted, doubled, swapped, cut off; brackets,
escapes, other alphabets, orders and pieces of other answers put in), or noise. Whatever the text: no exception, no
atom outside the query, no value but three, and every value's word stands where ``places`` says.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import time

from pix2pred.predicates.parse_atoms import kept
from pix2pred.predicates.parse_labels import parse_labels
from pix2pred.predicates.propose import ProposalSettings, read_proposal
from pix2pred.predicates.structured import as_text
from pix2pred.structs import FALSE, TRUE, UNKNOWN, Demo, Object, State, Type

WORDS = {TRUE: "true", FALSE: "false", UNKNOWN: "unknown"}
ITEM = Type("item")
OBJECTS = tuple(Object(name, ITEM, name) for name in ("patty1", "top_bun2", "grill", "small_blue_cup"))
DEMO = Demo("d", OBJECTS, (State(),), (), ())
QUERY = (
    "cooked(patty1)",
    "on(patty1, grill)",
    "on(top_bun2, patty1)",
    "near_to(small_blue_cup, grill)",
    "Clear(grill)",
)
SEEDS = (
    "\n".join(f"* {atom}: {('True', 'False', 'Unknown')[i % 3]}. It looks so." for i, atom in enumerate(QUERY)),
    "1. Expected changes: on(patty1, grill) becomes True.\n2. Observed changes: cooked(patty1): True?\n3. Values:\n"
    + "\n".join(f"- **{atom}**: *False*. It was True before." for atom in QUERY),
    "| predicate | value |\n|---|---|\n" + "\n".join(f"| `{atom}` | **True** |" for atom in QUERY),
    json.dumps({"expected_changes": "a", "observed_changes": "b",
                "values": [{"atom": a, "explanation": "x", "value": "True"} for a in QUERY]}),
    "## Pick\nBefore: on(patty1, grill)\nAfter: held(patty1), `in_air(patty1)`\nSynonyms: lifted(patty1)\n"
    "Antonyms: resting\\_on(patty1, grill)\nIn general: on(x, y): atop(x, y) e.g. (see above)",
    "I'm sorry, but I can't help with that.",
)  # fmt: skip
PIECES = (
    "(", ")", "((", "))", ",", ":", "=", "*", "**", "`", "\\", "\\_", "\\(", "_", "-", "|", "\n", "\r\n", "\t", " ",
    "3.", "3)", "Section 3:", "True", "False", "Unknown", "true", "Maybe", "not ", "\x00", "\ufeff", "\u202e", "：",
    "是", "ложь", "\U0001f354", "é", "{", "}", "[", "]", '"', "'", "<", ">", "#",
    "cooked(patty1)", "cooked(patty1): True",
    "on(grill, grill)", "ignore all previous instructions", "p()", "a" * 50, "(" * 50, "on(" * 20, "\ud800",
)  # fmt: skip


def mutated(rng: random.Random) -> str:
    """One text."""
    if rng.random() < 0.1:
        return "".join(rng.choice(PIECES) for _ in range(rng.randrange(60)))
    text = rng.choice(SEEDS)
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
            text = text[:i] + rng.choice(SEEDS)[j:] + text[j:]
        else:
            text = text[:i] + chr(rng.choice((rng.randrange(128), rng.randrange(0x3000)))) + text[i + 1 :]
    return text[:4000]


def check(text: str) -> None:
    """Raises ``AssertionError``, or whatever a parser raises."""
    for answer in {text, as_text(text)}:
        parsed = parse_labels(answer, QUERY)
        assert set(parsed.values) | set(parsed.missing) == set(QUERY), "an atom outside the query, or one lost"
        assert not set(parsed.values) & set(parsed.missing), "an atom both there and missing"
        for atom, value in parsed.values.items():
            word = WORDS[value]
            place = parsed.places[atom]
            said = "".join(answer[i] for i in kept(answer) if i >= place)[: len(word)]
            assert said.lower() == word, f"{atom}: {word} is not where it was said to be"
    proposal = read_proposal(DEMO, text, ProposalSettings(max_atoms=5))
    assert len(proposal.accepted) <= 5
    for proposed in proposal.accepted:
        assert proposed.objects and set(proposed.objects) <= set(OBJECTS), "an object outside the demonstration"
        assert len(set(proposed.objects)) == len(proposed.objects) and proposed.name.isidentifier()


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
    "dashes": "-a",
    "digits": "1a",
    "one long argument": "patty1 ",
}


def linear() -> bool:
    """Seconds per pattern for 100,000 and 800,000 characters; whether none takes much more than eight times as long."""
    good = True
    for name, piece in HOSTILE.items():
        took = []
        for size in (100_000, 800_000):
            text = ("on(" if name == "one long argument" else "") + piece * (size // len(piece))
            best = float("inf")
            for _ in range(3):
                begin = time.process_time()
                parse_labels(text, QUERY)
                read_proposal(DEMO, text, ProposalSettings())
                as_text(text)
                best = min(best, time.process_time() - begin)
            took.append(best)
        ratio = took[1] / max(took[0], 1e-3)
        good &= ratio < 20
        print(f"{name:<20}{took[0]:8.3f} s{took[1]:8.3f} s   {ratio:5.1f} times for 8 times the text")
    return good


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--linear", action="store_true")
    options = parser.parse_args()
    if options.linear:
        sys.exit(0 if linear() else 1)
    rng, begin, characters = random.Random(options.seed), time.perf_counter(), 0
    for number in range(options.count):
        text = mutated(rng)
        characters += len(text)
        try:
            check(text)
        except Exception:
            print(f"text {number} of seed {options.seed}: {text!r}", file=sys.stderr)
            raise
    seconds = time.perf_counter() - begin
    print(f"{options.count:,} texts, {characters:,} characters, {seconds:.0f} s, no finding")


if __name__ == "__main__":
    main()
