"""Cluster and intersect: the worked example, the table of required counts, and a naive implementation (method 5)."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from learning import random_tables
from learning.naive_operators import bijections, canonical, naive_operators, transitions
from learning.published import published
from learning.random_tables import BALL, BOX, THING, demo, random_table, table
from pix2pred.learning import LearningSettings, dump_traces, learn_operators
from pix2pred.learning.operators.cluster_and_intersect import ClusterAndIntersect
from pix2pred.learning.operators.clustering import partition, refine
from pix2pred.learning.operators.transition_class import TransitionClass
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Action, LabelledDemo, Object, Skill, TruthTable, Type, Variable, Vocabulary

SEEDS = st.integers(0, 2**32)


def worked_example() -> TruthTable:
    """Section 5.7: four Place transitions, each a demonstration of its own."""
    root = Type("object")
    item = Type("item", parent=root)
    robot_t, grill_t = Type("robot", parent=root), Type("grill", parent=root)
    patty_t, bun_t = Type("patty", parent=item), Type("bottom_bun", parent=item)
    robot, grill = Object("robot", robot_t), Object("grill", grill_t)
    patty1, patty2, bun = Object("patty1", patty_t), Object("patty2", patty_t), Object("bottom_bun1", bun_t)
    place = Skill("Place", (robot_t, item, root))
    clear, free = random_tables.given("Clear", root), random_tables.given("Free", robot_t)
    holding, on = random_tables.given("Holding", robot_t, item), random_tables.given("On", item, root)
    ground = random_tables.given("OnGround", item)
    cooked, hot = random_tables.candidate("cooked", patty_t), random_tables.candidate("hot", patty_t)
    objects = (robot, grill, patty1, patty2, bun)

    def one(name: str, patty: Object, target: Object, extra: bool, heated: bool) -> LabelledDemo:
        kept = {ground(bun)} | ({cooked(patty)} if extra else set())
        before = {clear(target), holding(robot, patty)} | kept
        after = {on(patty, target), clear(patty), free(robot)} | kept | ({hot(patty)} if heated else set())
        return demo(name, objects, [Action(place, (robot, patty, target))], [before, after])

    demos = (
        one("T1", patty1, grill, False, False),
        one("T2", patty2, grill, True, False),
        one("T3", patty1, bun, True, False),
        one("T4", patty2, grill, True, True),
    )
    return table((clear, free, holding, on, ground), (cooked, hot), demos)


def lines(table_: TruthTable, settings_: LearningSettings) -> list[str]:
    return [str(op) for op in learn_operators(table_, settings_)]


OP0 = """Op0(?x0:grill, ?x1:patty, ?x2:robot)  Place(?x2, ?x1, ?x0)
  pre Clear(?x0), Holding(?x2, ?x1)
  add Clear(?x1), Free(?x2), On(?x1, ?x0)
  del Clear(?x0), Holding(?x2, ?x1)"""
OP1 = """Op1(?x0:bottom_bun, ?x1:patty, ?x2:robot)  Place(?x2, ?x1, ?x0)
  pre Clear(?x0), Holding(?x2, ?x1), OnGround(?x0), cooked(?x1)
  add Clear(?x1), Free(?x2), On(?x1, ?x0)
  del Clear(?x0), Holding(?x2, ?x1)"""
OP2 = """Op2(?x0:grill, ?x1:patty, ?x2:robot)  Place(?x2, ?x1, ?x0)
  pre Clear(?x0), Holding(?x2, ?x1), cooked(?x1)
  add Clear(?x1), Free(?x2), On(?x1, ?x0), hot(?x1)
  del Clear(?x0), Holding(?x2, ?x1)"""


@pytest.mark.parametrize(
    ("h_data", "expected"), [(0.05, [OP0, OP1, OP2]), (0.25, [OP0, OP1, OP2]), (0.4, [OP0]), (0.5, [OP0]), (0.6, [])]
)
def test_worked_example(h_data: float, expected: list[str]) -> None:
    assert lines(worked_example(), published(h_data_frac=h_data)) == expected


def test_worked_example_supports_and_soft_intersection() -> None:
    assert [op.support for op in learn_operators(worked_example(), published())] == [2, 1, 1]
    half = OP0.replace("Holding(?x2, ?x1)\n  add", "Holding(?x2, ?x1), cooked(?x1)\n  add")
    assert lines(worked_example(), published(h_pre_frac=0.5))[0] == half
    assert lines(worked_example(), published(h_pre_frac=0.5, precondition_rule="more_than"))[0] == OP0


def test_hard_intersection_at_one_keeps_what_always_holds() -> None:
    for rule in ("at_least", "more_than"):
        chosen = published(h_pre_frac=1.0, precondition_rule=rule)
        assert lines(worked_example(), chosen) == [OP0, OP1, OP2]


@pytest.mark.parametrize(
    ("rule", "needed"),
    [
        ("more_than", {1: 1, 2: 2, 3: 3, 4: 4, 5: 5, 6: 5, 7: 6, 8: 7, 9: 8, 10: 9, 11: 9, 12: 10, 15: 13}),
        ("at_least", {1: 1, 2: 2, 3: 3, 4: 4, 5: 4, 6: 5, 7: 6, 8: 7, 9: 8, 10: 8, 11: 9, 12: 10, 15: 12}),
    ],
)
def test_required_counts_of_the_table(rule: str, needed: dict[int, int]) -> None:
    learner = ClusterAndIntersect(strictly=rule == "more_than")
    assert {n: learner.required_count(n) for n in needed} == needed


@given(st.integers(1, 400), st.integers(0, 100), st.booleans())
def test_required_counts_are_exact_for_every_percentage(n: int, percent: int, strict: bool) -> None:
    learner = ClusterAndIntersect(h_pre_frac=percent / 100, strictly=strict)
    share_is_exclusive = strict and percent < 100
    enough = next(
        c for c in range(n + 2) if 100 * c > percent * n or (100 * c == percent * n and not share_is_exclusive)
    )
    assert learner.required_count(n) == enough


def test_pruning_leaves_gaps_in_the_numbers() -> None:
    a, b, hot = Object("a", BALL), Object("b", BALL), random_tables.given("Hot", BALL)
    heat, touch = Skill("Heat", (BALL,)), Skill("Touch", (BALL,))

    def one(skill: Skill, o: Object, after: set[Object]) -> LabelledDemo:
        return demo("d", (a, b), [Action(skill, (o,))], [[], [hot(x) for x in after]])

    demos = [one(heat, a, {b}), *(one(heat, x, {x}) for x in (a, b, a)), one(touch, a, {b})]
    found = learn_operators(table([hot], [], demos), published(h_data_frac=0.3))
    assert [(op.name, op.support) for op in found] == [("Op1", 3), ("Op2", 1)]  # a share of each skill's own


@pytest.mark.parametrize(("share", "kept"), [(0.05, 2), (0.051, 1)])
def test_data_share_is_inclusive(share: float, kept: int) -> None:
    a, hot = Object("a", BALL), random_tables.given("Hot", BALL)
    heat = Skill("Heat", (BALL,))
    changed = demo("d", [a], [Action(heat, (a,))], [[], [hot(a)]])
    same = demo("d", [a], [Action(heat, (a,))], [[], []])
    found = learn_operators(table([hot], [], [same, *[changed] * 19]), published(h_data_frac=share))
    assert len(found) == kept


def test_objects_beside_the_arguments_need_a_search() -> None:
    """In(x, y) and Clear(y): which of the side objects is which follows only from all effects together."""
    inside, clear = random_tables.given("In", THING, THING), random_tables.given("Clear", THING)
    go = Skill("Go", ())
    a, b, c = (Object(n, BALL) for n in "abc")

    def one(x: Object, y: Object, z: Object) -> LabelledDemo:
        return demo("d", (a, b, c), [Action(go, ())], [[clear(z)], [inside(x, y), inside(y, z), clear(z)]])

    (op,) = learn_operators(table([inside, clear], [], [one(a, b, c), one(c, a, b), one(b, c, a)]), published())
    assert str(op) == (
        "Op0(?x0:ball, ?x1:ball, ?x2:ball)  Go()\n  pre Clear(?x2)\n  add In(?x0, ?x1), In(?x1, ?x2)\n  del -"
    )
    circle = demo("d", (a, b, c), [Action(go, ())], [[], [inside(a, b), inside(b, a)]])
    found = learn_operators(table([inside, clear], [], [one(a, b, c), circle]), published())
    assert [op.support for op in found] == [1, 1]


def test_interchangeable_objects_take_the_first_bijection_in_sorted_order() -> None:
    hot, clear = random_tables.given("Hot", BALL), random_tables.given("Clear", THING)
    go = Skill("Go", ())
    a, b = Object("a", BALL), Object("b", BALL)

    def one(marked: Object) -> LabelledDemo:
        return demo("d", (a, b), [Action(go, ())], [[clear(marked)], [clear(marked), hot(a), hot(b)]])

    (op,) = learn_operators(table([hot, clear], [], [one(a), one(a)]), published())
    assert [str(p) for p in op.preconditions] == ["Clear(?x0)"]
    (op,) = learn_operators(table([hot, clear], [], [one(a), one(b)]), published())
    assert op.preconditions == frozenset()  # a to a and b to b: the marks do not line up


def test_types_must_be_equal_not_related() -> None:
    clear, touch = random_tables.given("Clear", THING), Skill("Touch", (THING,))
    things = (Object("a", BALL), Object("b", BOX), Object("c", THING), Object("d", BALL))
    demos = [demo("d", [o], [Action(touch, (o,))], [[], [clear(o)]]) for o in things]
    found = learn_operators(table([clear], [], demos), published(h_data_frac=0))
    assert [(op.parameters[0].type.name, op.support) for op in found] == [("ball", 2), ("box", 1), ("thing", 1)]


def test_add_and_delete_never_mix_and_repeated_arguments_differ_from_distinct_ones() -> None:
    inside = random_tables.given("In", THING, THING)
    put = Skill("Put", (THING, THING))
    a, b = Object("a", THING), Object("b", THING)
    added = demo("d", (a, b), [Action(put, (a, b))], [[], [inside(a, b)]])
    deleted = demo("d", (a, b), [Action(put, (a, b))], [[inside(a, b)], []])
    looped = demo("d", (a, b), [Action(put, (a, a))], [[], [inside(a, a)]])
    found = learn_operators(table([inside], [], [added, deleted, looped]), published())
    assert [(len(op.parameters), len(op.add), len(op.delete)) for op in found] == [(2, 1, 0), (2, 0, 1), (1, 1, 0)]


def test_a_skill_without_arguments_and_effects_on_no_object_makes_one_class() -> None:
    lit, go = random_tables.given("Lit"), Skill("Go", ())
    one = demo("d", [Object("a", BALL)], [Action(go, ())], [[], [lit()]])
    found = learn_operators(table([lit], [], [one, one, one]), published(h_data_frac=0.4))
    assert [(op.name, op.support) for op in found] == [("Op0", 3)]


def test_hostile_no_demonstrations_no_actions_no_objects() -> None:
    lit = random_tables.given("Lit")
    assert learn_operators(table([lit], [], []), published()) == ()
    assert learn_operators(table([lit], [], [demo("d", [], [], [[lit()]])]), published()) == ()


def test_unknown_labels_count_as_false() -> None:
    source = worked_example()
    t4 = source.demos[3]
    values = t4.values.copy()
    values[1, [a.predicate.name for a in t4.atoms].index("hot")] = -1
    changed = LabelledDemo(t4.name, t4.objects, t4.actions, t4.goal, t4.atoms, values)
    found = learn_operators(TruthTable(source.initial, source.pool, (*source.demos[:3], changed)), published())
    assert [op.support for op in found] == [3, 1]


# --- against the naive implementation -------------------------------------------------------------------------------


@given(SEEDS, st.sampled_from([0.0, 0.5, 0.75, 0.8, 1.0]), st.sampled_from([0.0, 0.05, 0.3, 0.5, 1.0]), st.booleans())
@settings(max_examples=300, deadline=None)
def test_agrees_with_the_naive_implementation(seed: int, h_pre: float, h_data: float, strict: bool) -> None:
    source = random_table(seed)
    rule = "more_than" if strict else "at_least"
    chosen = published(h_pre_frac=h_pre, h_data_frac=h_data, precondition_rule=rule)
    assert learn_operators(source, chosen) == naive_operators(source, h_pre, h_data, strict)


@given(SEEDS, st.sampled_from([0.5, 0.8, 1.0]))
@settings(max_examples=150, deadline=None)
def test_structural_laws(seed: int, h_pre: float) -> None:
    source = random_table(seed)
    for op in learn_operators(source, published(h_pre_frac=h_pre)):
        assert list(op.broken_laws()) == []
        assert op.support >= 1
        assert [v.name for v in op.parameters] == [f"?x{i}" for i in range(len(op.parameters))]


@given(SEEDS)
@settings(max_examples=100, deadline=None)
def test_the_order_of_predicates_atoms_and_objects_does_not_matter(seed: int) -> None:
    source, rng = random_table(seed), Random(seed)

    def shuffled(d: LabelledDemo) -> LabelledDemo:
        order = rng.sample(range(len(d.atoms)), len(d.atoms))
        objects = tuple(rng.sample(d.objects, len(d.objects)))
        return LabelledDemo(d.name, objects, d.actions, d.goal, tuple(d.atoms[i] for i in order), d.values[:, order])

    mixed = TruthTable(
        tuple(rng.sample(source.initial, len(source.initial))),
        tuple(rng.sample(source.pool, len(source.pool))),
        tuple(shuffled(d) for d in source.demos),
    )
    assert learn_operators(mixed, published()) == learn_operators(source, published())


@given(SEEDS)
@settings(max_examples=150, deadline=None)
def test_the_order_of_demonstrations_changes_only_numbers_and_names_of_variables(seed: int) -> None:
    source, rng = random_table(seed, interchangeable=bool(seed % 2)), Random(seed)
    mixed = TruthTable(source.initial, source.pool, tuple(rng.sample(source.demos, len(source.demos))))
    every = transitions(source)
    unique = all(len(bijections(t, t)) == 1 for t in every)  # no interchangeable objects anywhere
    before, after = (learn_operators(t, published(h_data_frac=0)) for t in (source, mixed))
    assert sorted(repr(canonical(op, unique)) for op in before) == sorted(repr(canonical(op, unique)) for op in after)


def _plain(classes: tuple[TransitionClass, ...], data: IndexedTable) -> list[tuple[object, ...]]:
    counts = [tuple(c.counts_before(data, p) for p in range(len(data.predicates))) for c in classes]
    return [
        (c.skill, c.types, c.skill_args, set(c.add), set(c.delete), c.members, n)
        for c, n in zip(classes, counts, strict=True)
    ]


@given(SEEDS)
@settings(max_examples=150, deadline=None)
def test_refining_equals_partitioning_from_scratch(seed: int) -> None:
    data = IndexedTable(random_table(seed))
    order = Random(seed).sample(range(len(data.predicates)), len(data.predicates))
    classes = partition(data, [])
    for i, p in enumerate(order):
        refined = refine(data, classes, order[:i], p)
        assert _plain(refined, data) == _plain(partition(data, order[: i + 1]), data)
        unchanged = [c for c in classes if data.changing(p).isdisjoint(m.transition for m in c.members)]
        assert all(any(c is r for r in refined) for c in unchanged)
        classes = refined


_CHILD = """
import sys
from pathlib import Path
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators, load_traces
traces = load_traces(Path(sys.argv[1]))
published = LearningSettings(operators="cluster-and-intersect", j_threshold=0, max_plans=20)
for op in learn_operators(traces.table, published):
    print(op)
settings = published
found = hill_climbing(traces.table, settings).run()
for step in found.steps:
    print(step.added, repr(step.j), [(r.predicate.name, repr(r.j)) for r in step.runners_up])
"""


def test_output_does_not_depend_on_the_hash_seed(tmp_path: Path) -> None:
    source = worked_example()
    path = tmp_path / "traces.json"
    skills = tuple({a.skill: None for d in source.demos for a in d.actions})
    types = tuple(sorted({t for o in source.demos[0].objects for t in _line(o.type)}, key=str))
    path.write_text(dump_traces(Vocabulary("v", types, skills, source.initial), source, {}))
    assert json.loads(path.read_text())["version"] == 1
    outputs = {
        subprocess.run(
            [sys.executable, "-c", _CHILD, str(path)],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "1", "4242")
    }
    assert len(outputs) == 1
    assert outputs.pop().startswith(OP0)


def _line(t: Type | None) -> list[Type]:
    return [] if t is None else [t, *_line(t.parent)]


def test_variables_are_numbered_by_object_name_not_by_argument_order() -> None:
    put = Skill("Put", (BALL, BOX))
    inside = random_tables.given("In", THING, THING)
    box, ball = Object("a_box", BOX), Object("z_ball", BALL)
    one = demo("d", (box, ball), [Action(put, (ball, box))], [[], [inside(ball, box)]])
    (op,) = learn_operators(table([inside], [], [one]), published())
    assert op.parameters == (Variable("?x0", BOX), Variable("?x1", BALL))
    assert op.skill_args == (Variable("?x1", BALL), Variable("?x0", BOX))
