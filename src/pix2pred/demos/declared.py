"""From ``domain.yaml`` to types, skills, initial predicates and objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from pix2pred.demos.files.documents import DomainDoc, Sheet
from pix2pred.demos.files.yaml_lines import Loc
from pix2pred.structs import Object, Predicate, Skill, Type, Vocabulary
from pix2pred.structs.formats.building import MAX_ANCESTORS, build_predicate, build_skill, build_types, trigger_faults
from pix2pred.structs.formats.documents import ObjectDoc, PredicateDoc, SkillDoc, TypeDoc
from pix2pred.structs.formats.names import UnknownNameError

_NEEDED = {
    "types": "the kinds of objects, such as '- {name: cup}'",
    "skills": "what can be done, such as '- {name: Pick, types: [robot, cup]}'",
    "predicates": "what goals are written in, such as '- {name: On, types: [cup, tray], source: vlm}'",
}
"""What no domain can be without."""
_NEARLY = "{} {} differs from {} in capitals alone, and PDDL takes both for one: rename it"


@dataclass(frozen=True, slots=True)
class Declared:
    """The names demonstrations and tasks may use.

    ``broken`` are names declared with a problem that is already reported: their uses are not reported again.
    """

    vocabulary: Vocabulary
    objects: Mapping[str, Object]
    broken: frozenset[str] = frozenset()


def build_declared(sheet: Sheet, doc: DomainDoc) -> Declared:
    """Resolve ``doc`` as far as it is sound; problems go to the sheet."""
    for key, example in _NEEDED.items():
        if not getattr(doc, key):
            sheet.report((key,), f"to be filled in: {example}")
    builder = _Builder(sheet)
    types = builder.types(doc.types)
    skills = builder.skills(doc.skills)
    predicates = builder.predicates(doc.predicates)
    objects = resolve_objects(sheet, doc.objects, builder.table, builder.broken)
    return Declared(Vocabulary(doc.name, types, skills, predicates), objects, frozenset(builder.broken))


def resolve_objects(
    sheet: Sheet, docs: Mapping[str, ObjectDoc], types: Mapping[str, Type], broken: set[str]
) -> dict[str, Object]:
    """The objects of a mapping ``objects: {name: {type, descriptor}}``; names left out are added to ``broken``."""
    objects: dict[str, Object] = {}
    spelled: dict[str, str] = {}
    for name, doc in docs.items():
        if (other := spelled.setdefault(name.casefold(), name)) != name:
            sheet.report(("objects", name), _NEARLY.format("object", repr(name), repr(other)))
        if doc.type in types and doc.type not in broken:
            objects[name] = Object(name, types[doc.type], doc.descriptor or name)
            continue
        if doc.type not in broken:
            sheet.report(("objects", name, "type"), str(UnknownNameError("type", doc.type, types)))
        broken.add(name)
    return objects


@dataclass(slots=True)
class _Builder:
    """Goes through the file entry by entry, so that one wrong entry does not hide the next."""

    sheet: Sheet
    table: dict[str, Type] = field(default_factory=dict)
    skill_table: dict[str, Skill] = field(default_factory=dict)
    broken: set[str] = field(default_factory=set)

    def types(self, docs: Sequence[TypeDoc]) -> tuple[Type, ...]:
        """The types whose ancestors are sound."""
        firsts = {docs[i].name: docs[i] for i in self._first_positions("types", "type", [d.name for d in docs])}
        for position, doc in enumerate(docs):
            if len(set(doc.features)) != len(doc.features) or not all(doc.features):
                self.sheet.report(("types", position, "features"), "feature names must be distinct and not empty")
            if doc.parent is not None and doc.parent not in firsts:
                message = str(UnknownNameError("type", doc.parent, firsts))
                self.sheet.report(("types", position, "parent"), message)
                self.broken.add(doc.name)
        for position, doc in enumerate(docs):
            self._check_ancestors(position, doc, firsts)
        self.table = {t.name: t for t in build_types(d for d in firsts.values() if d.name not in self.broken)}
        return tuple(self.table.values())

    def _check_ancestors(self, position: int, doc: TypeDoc, docs: Mapping[str, TypeDoc]) -> None:
        node, visited = doc, set[str]()
        for _ in range(MAX_ANCESTORS):
            visited.add(node.name)
            if node.parent is None or node.parent not in docs:
                return
            node = docs[node.parent]
            if node.name == doc.name:
                self.sheet.report(("types", position, "parent"), f"type {doc.name!r} is its own ancestor")
                self.broken.add(doc.name)
                return
            if node.name in self.broken or node.name in visited:
                self.broken.add(doc.name)
                return
        self.sheet.report(("types", position, "parent"), f"type {doc.name!r} has more than {MAX_ANCESTORS} ancestors")
        self.broken.add(doc.name)

    def skills(self, docs: Sequence[SkillDoc]) -> tuple[Skill, ...]:
        """The skills over sound types."""
        for position in self._first_positions("skills", "skill", [d.name for d in docs]):
            doc, loc = docs[position], ("skills", position)
            if not self._known_types(doc.name, doc.types, loc):
                continue
            try:
                self.skill_table[doc.name] = build_skill(doc, self.table)
            except ValueError as error:
                self.sheet.report((*loc, "low"), str(error))
                self.broken.add(doc.name)
        return tuple(self.skill_table.values())

    def predicates(self, docs: Sequence[PredicateDoc]) -> tuple[Predicate, ...]:
        """The predicates over sound types."""
        built = []
        for position in self._first_positions("predicates", "predicate", [d.name for d in docs]):
            doc, loc = docs[position], ("predicates", position)
            if not self._known_types(doc.name, doc.types, loc):
                continue
            try:
                predicate = build_predicate(doc, self.table)
            except ValueError as error:
                self.sheet.report((*loc, "source"), str(error))
                self.broken.add(doc.name)
                continue
            built.append(predicate)
            for fault in trigger_faults(predicate, self.skill_table):
                if fault.skill not in self.broken:
                    self.sheet.report((*loc, *fault.where), fault.message)
        return tuple(built)

    def _known_types(self, owner: str, types: Sequence[str], loc: Loc) -> bool:
        for position, name in enumerate(types):
            if name not in self.table:
                if name not in self.broken:
                    message = str(UnknownNameError("type", name, self.table))
                    self.sheet.report((*loc, "types", position), message)
                self.broken.add(owner)
        return owner not in self.broken

    def _first_positions(self, key: str, kind: str, names: Sequence[str]) -> list[int]:
        """Where each name is declared first; later declarations are problems, and names that are nearly the same."""
        firsts: dict[str, int] = {}
        for position, name in enumerate(names):
            first = firsts.setdefault(name.casefold(), position)
            if first != position:
                line = self.sheet.yaml.line((key, first, "name"))
                message = f"{kind} {name!r} is declared twice (first on line {line})"
                if name != names[first]:
                    message = _NEARLY.format(kind, repr(name), f"{names[first]!r} (line {line})")
                    self.broken.add(name)
                self.sheet.report((key, position, "name"), message)
        return list(firsts.values())
