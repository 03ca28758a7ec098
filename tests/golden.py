"""The published operators (tests/data/paper_operators) as operators, for tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from pix2pred.structs import FromDomain, LiftedAtom, Object, Operator, Predicate, Skill, Type, Variable

DATA = Path(__file__).parent / "data"
MODELS = ("kitchen", "more_burger_stacks", "bigger_burger", "combo_burger", "coffee", "cleanup", "juice")

_PARENTS = {
    "patty": "item", "lettuce": "item", "cheese": "item", "bottom_bun": "item", "top_bun": "item",
    "grill": "station", "cutting_board": "station", "item": "object", "station": "object", "robot": "object",
    "table": "immovable", "trash_can": "immovable",
}  # fmt: skip


def golden_type(name: str) -> Type:
    parent = _PARENTS.get(name)
    return Type(name, parent=golden_type(parent) if parent else None)


def load_operators(model: str) -> tuple[Operator, ...]:
    """Predicates carry the printed name and no argument types: one printed name has several signatures."""
    document = yaml.safe_load((DATA / "paper_operators" / f"{model}.yaml").read_text())
    return tuple(_operator(doc) for doc in document["operators"])


def printed(name: str) -> Predicate:
    return Predicate(name, (), FromDomain())


def _operator(doc: dict[str, Any]) -> Operator:
    variables = {p["name"]: Variable(p["name"], golden_type(p["type"])) for p in doc["parameters"]}

    def atoms(group: list[dict[str, Any]]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(printed(a["predicate"]), tuple(variables[v] for v in a["args"])) for a in group)

    skill_args = tuple(variables[v] for v in doc["skill"]["args"])
    skill = Skill(doc["skill"]["name"], tuple(v.type for v in skill_args))
    return Operator(
        doc["name"],
        tuple(variables.values()),
        atoms(doc["preconditions"]),
        atoms(doc["add"]),
        atoms(doc["delete"]),
        Skill(skill.name, ()),
        skill_args,
    )


def objects(spec: str) -> dict[str, Object]:
    """``"robot:robot patty1:patty"`` as objects by name."""
    pairs = (item.split(":") for item in spec.split())
    return {name: Object(name, golden_type(type_name)) for name, type_name in pairs}
