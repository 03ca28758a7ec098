"""Corrections applied to a truth table: each kind, undoing, and rows that make no sense."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pix2pred.learning.operators.contrary_words import with_contrary_words
from pix2pred.predicates.correction_rows import CorrectionsError, parse_row, read_rows, row_line
from pix2pred.predicates.corrections import Corrections
from pix2pred.predicates.labelling.explanations import explanations
from pix2pred.structs import (
    Action,
    Atom,
    Candidate,
    FromHuman,
    FromVLM,
    LabelledDemo,
    Object,
    Predicate,
    Skill,
    TruthTable,
    Type,
)

LAMP = Type("lamp")
A, B = Object("a", LAMP), Object("b", LAMP)
GIVEN = Predicate("Done", (LAMP,), FromHuman())
LIT = Predicate("lit", (LAMP,), FromVLM("lit"))
GLOWS = Predicate("glows", (LAMP,), FromVLM("glows"))
PRESS = Skill("Press", (LAMP,))


def table() -> TruthTable:
    atoms = tuple(sorted((GLOWS(A), LIT(A), GIVEN(A))))
    values = np.array([[0, 0, 0], [1, 1, -1]], dtype=np.int8)  # Done, glows, lit
    demo = LabelledDemo("d", (A, B), (Action(PRESS, (A,)),), (GIVEN(A),), atoms, values)
    return TruthTable((GIVEN,), (Candidate(GLOWS, 1.0), Candidate(LIT, 1.0)), (demo,))


def row(kind: str, **fields: Any) -> Any:
    import json

    return parse_row(json.dumps({"kind": kind, "when": "2026-01-01T00:00:00Z", **fields}))


def value(t: TruthTable, text: str, state: int) -> int:
    demo = t.demos[0]
    return int(demo.values[state, [str(a) for a in demo.atoms].index(text)])


def test_labels_are_set_also_where_everything_was_false() -> None:
    rows = [
        row("label", demo="d", state=1, atom=["lit", "a"], old="unknown", new="true"),
        row("label", demo="d", state=0, atom=["lit", "b"], old="false", new="unknown"),
        row("label", demo="d", state=1, atom=["lit", "a"], old="true", new="false"),
    ]
    corrected = Corrections.of(rows).apply(table()).table
    assert value(corrected, "lit(a)", 1) == 0
    assert [value(corrected, "lit(b)", t) for t in (0, 1)] == [-1, 0]
    assert list(corrected.demos[0].atoms) == sorted(corrected.demos[0].atoms)


def test_confidence_follows_its_labels_and_says_nothing_of_corrected_ones() -> None:
    said = table()
    sure = np.array([[0.9, 0.6, 0.7], [0.9, 0.8, 0.5]], dtype=np.float32)
    said = replace(said, demos=(replace(said.demos[0], confidence=sure),))
    rows = [
        row("label", demo="d", state=0, atom=["lit", "a"], old="false", new="true"),
        row("label", demo="d", state=1, atom=["lit", "b"], old="false", new="true"),
        row("merge", predicate="glows", old=None, new="lit"),
    ]
    demo = Corrections.of(rows).apply(said).table.demos[0]
    assert [str(a) for a in demo.atoms] == ["Done(a)", "lit(a)", "lit(b)"]
    assert demo.confidence is not None
    expected = np.array([[0.9, np.nan, np.nan], [0.9, 0.8, np.nan]], dtype=np.float32)
    np.testing.assert_array_equal(demo.confidence, expected)


def test_a_corrected_label_holds_for_the_declared_contrary_too() -> None:
    lit = replace(LIT, source=FromVLM("lit", opposite=("dark",)))
    said = table()
    pool = tuple(replace(c, predicate=lit) if c.predicate == LIT else c for c in said.pool)
    demo = said.demos[0]
    atoms = tuple(Atom(lit, a.objects) if a.predicate == LIT else a for a in demo.atoms)
    said = with_contrary_words(replace(said, pool=pool, demos=(replace(demo, atoms=atoms),)))
    assert [value(said, "dark0(a)", t) for t in (0, 1)] == [1, -1]
    one = row("label", demo="d", state=1, atom=["lit", "a"], old="unknown", new="true")
    other = row("label", demo="d", state=0, atom=["dark0", "a"], old="true", new="false")
    both = Corrections.of([one, other]).apply(said).table
    assert [value(both, "lit(a)", t) for t in (0, 1)] == [1, 1]
    assert [value(both, "dark0(a)", t) for t in (0, 1)] == [0, 0]
    own = row("label", demo="d", state=1, atom=["dark0", "a"], old="unknown", new="true")
    assert value(Corrections.of([one, own]).apply(said).table, "dark0(a)", 1) == 1, "a row of its own counts"


def test_renamed_predicates_keep_the_models_word() -> None:
    corrected = Corrections.of([row("rename", predicate="lit", old="lit", new="Alight")]).apply(table()).table
    assert Predicate("Alight", (LAMP,), FromVLM("lit")) in [c.predicate for c in corrected.pool]
    assert value(corrected, "Alight(a)", 1) == -1


def test_a_merged_synonym_leaves_the_pool_and_fills_in_the_unknown() -> None:
    corrected = Corrections.of([row("merge", predicate="glows", old=None, new="lit")]).apply(table()).table
    assert [c.predicate for c in corrected.pool] == [LIT]
    assert value(corrected, "lit(a)", 1) == 1
    undone = [
        row("merge", predicate="glows", old=None, new="lit"),
        row("merge", predicate="glows", old="lit", new=None),
    ]
    assert Corrections.of(undone).apply(table()).table == table()


def test_banned_predicates_leave_and_pinned_ones_are_named() -> None:
    rows = [
        row("standing", predicate="lit", old="free", new="banned"),
        row("standing", predicate="glows", old="free", new="pinned"),
    ]
    corrected = Corrections.of(rows).apply(table())
    assert [c.predicate for c in corrected.table.pool] == [GLOWS] == list(corrected.pinned)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([("rename", {"predicate": "Done", "old": "Done", "new": "Finished"})], "given predicate"),
        ([("rename", {"predicate": "glow", "old": "glow", "new": "x"})], "did you mean 'glows'"),
        ([("rename", {"predicate": "lit", "old": "lit", "new": "glows"})], "two predicates are called glows"),
        (
            [("label", {"demo": "e", "state": 0, "atom": ["lit", "a"], "old": "true", "new": "false"})],
            "no demonstration",
        ),
        ([("label", {"demo": "d", "state": 2, "atom": ["lit", "a"], "old": "true", "new": "false"})], "no state 2"),
        ([("label", {"demo": "d", "state": 0, "atom": ["lit"], "old": "true", "new": "false"})], "takes 1 arguments"),
        (
            [
                ("merge", {"predicate": "lit", "old": None, "new": "glows"}),
                ("merge", {"predicate": "glows", "old": None, "new": "lit"}),
            ],
            "merged with itself",
        ),
    ],
)
def test_rows_that_make_no_sense_are_refused(rows: list[tuple[str, dict[str, Any]]], message: str) -> None:
    with pytest.raises(CorrectionsError, match=message):
        Corrections.of([row(kind, **fields) for kind, fields in rows]).apply(table())


def test_the_file_survives_a_torn_last_line_and_names_other_bad_ones(tmp_path: Path) -> None:
    path = tmp_path / "corrections.jsonl"
    good = row_line(row("standing", predicate="lit", old="free", new="banned"))
    path.write_bytes(good + good[:20])
    assert len(read_rows(path)) == 1
    path.write_bytes(good[:20] + b"\n" + good)
    with pytest.raises(CorrectionsError, match="line 1"):
        read_rows(path)


def test_explanations_beside_and_elsewhere() -> None:
    answer = (
        "2. Changes: lit(a) is now bright\n3. Values:\n* lit(a): True\n* lit(b): False. It is dark.\n* odd(a): True"
    )
    assert explanations(answer, ["lit(a)", "lit(b)"]) == {
        "lit(a)": "Changes: lit(a) is now bright",
        "lit(b)": "It is dark.",
    }


def test_a_meaning_is_reworded_and_nothing_else_changes() -> None:
    rows = [
        row("meaning", predicate="lit", old="", new="It shines."),
        row("rename", predicate="lit", old="lit", new="on"),
    ]
    corrected = Corrections.of(rows).apply(table()).table
    assert [(c.predicate.name, c.predicate.description) for c in corrected.pool] == [
        ("glows", ""),
        ("on", "It shines."),
    ]
    assert {a.predicate.name: a.predicate.description for a in corrected.demos[0].atoms}["on"] == "It shines."
    assert (corrected.demos[0].values == Corrections.of(rows[1:]).apply(table()).table.demos[0].values).all()
    with pytest.raises(CorrectionsError, match="Done is a given predicate"):
        Corrections.of([row("meaning", predicate="Done", old="", new="x")]).apply(table())
    with pytest.raises(CorrectionsError, match="new"):
        row("meaning", predicate="lit", old="", new="two\nlines")
