"""What became of every proposed predicate and every rejected line, in a sentence each."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass

from pix2pred.predicates.correction_rows import Standing
from pix2pred.report.contents import Contents
from pix2pred.report.sections.curve import j_text
from pix2pred.runs.verdict import meaning
from pix2pred.structs import FromVLM, Label, Predicate
from pix2pred.structs.predicates import source_name

ORDER = ("selected", "dropped", "same", "runner-up", "candidate", "never true", "merged", "banned")


@dataclass(frozen=True, slots=True)
class PoolEntry:
    """A predicate of the pool. ``name`` is the model's, ``shown`` the present one; ``true`` and ``labels`` count."""

    name: str
    shown: str
    types: tuple[str, ...]
    source: str
    proposed: int
    true: int
    labels: int
    status: str
    why: str
    meaning: str = ""


@dataclass(frozen=True, slots=True)
class Rejected:
    """A line that was not used, why, and in how many demonstrations."""

    text: str
    reason: str
    demos: int


def pool_entries(contents: Contents) -> list[PoolEntry]:
    """The pool, selected predicates first, then by how close they came."""
    corrections = contents.learned_corrections
    counts: Counter[Predicate] = Counter()
    totals: Counter[Predicate] = Counter()
    for demo in contents.said.demos:
        for i, atom in enumerate(demo.atoms):
            counts[atom.predicate] += int((demo.values[:, i] == Label.TRUE).sum())
            totals[atom.predicate] += len(demo.values)
    proposed: Counter[str] = Counter()
    for proposal in contents.proposals:
        proposed.update({accepted.partition("(")[0] for accepted in proposal["accepted"]})
    fates = _fates(contents)
    entries = []
    for candidate in contents.said.pool:
        p = candidate.predicate
        shown = corrections.names.get(p.name, p.name)
        if p.name in corrections.merged:
            status, why = "merged", f"a person merged it with {corrections.merged[p.name]}"
        elif corrections.standing.get(p.name) is Standing.BANNED:
            status, why = "banned", "a person banned it"
        elif shown in fates:
            status, why = fates[shown]
        elif counts[p] == 0:
            status, why = "never true", "true in no state of any demonstration, so no candidate"
        else:
            status, why = "candidate", "never among the ten best candidates of a step"
        phrase = p.source.phrase if isinstance(p.source, FromVLM) else ""
        entries.append(
            PoolEntry(
                p.name, shown, tuple(t.name for t in p.types), source_name(p.source),
                proposed[phrase], counts[p], totals[p], status, why, meaning(p),
            )
        )  # fmt: skip
    return sorted(entries, key=lambda e: (ORDER.index(e.status), e.shown))


def _fates(contents: Contents) -> dict[str, tuple[str, str]]:
    """What selection did with a candidate, by its present name; the last word counts."""
    fates: dict[str, tuple[str, str]] = {}
    steps = contents.selection["steps"]
    for i, step in enumerate(steps):
        for rank, runner in enumerate(step["runners_up"], start=2):
            why = f"number {rank} of step {i}, with J {j_text(runner)} where the winner had {step['J']:,.0f}"
            fates[runner["predicate"]] = ("runner-up", why)
    for i, step in enumerate(steps[1:], start=1):
        bought = steps[i - 1]["J"] - step["J"]
        fates[step["added"]] = ("selected", f"step {i}: lowered J by {bought:,.0f}, to {step['J']:,.0f}")
    for name in contents.selection.get("pinned", ()):
        fates[name] = ("selected", "a person pinned it")
    for chosen, others in contents.selection["identical_columns"].items():
        for name in others:
            fates[name] = ("same", f"has the same value as {chosen} everywhere")
    for name in contents.selection["dropped"]:
        fates[name] = ("dropped", "was chosen on the way, but no final operator needs it")
    return fates


def rejected_lines(contents: Contents) -> list[Rejected]:
    """Lines of the model's answers that were not used, the most frequent first."""
    seen: dict[tuple[str, str], set[str]] = defaultdict(set)
    for proposal in contents.proposals:
        for line in proposal["rejected"]:
            seen[line["text"], line["reason"]].add(proposal["demo"])
    found = [Rejected(text, reason, len(demos)) for (text, reason), demos in seen.items()]
    return sorted(found, key=lambda r: (-r.demos, r.text, r.reason))
