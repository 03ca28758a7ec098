"""What a model's words mean: its own sentences, read from its proposals and written into its questions."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from pix2pred.predicates.prompt import meaning_lines
from pix2pred.structs import Atom, FromVLM, Predicate, Skill

_STAYS = re.compile(r"\b(?:stays?|static|never)\b", re.IGNORECASE)
_RELATED = re.compile(r"[ \t]*(also|opposite)[ \t]*:(.*)", re.IGNORECASE)
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")

_PLACEHOLDERS = {"meaning", "a sentence", "one sentence", "description", "definition", "todo", "tbd", "none", "n a"}
_ABOVE = re.compile(r"(?:the )?(?:same )?(?:as|see) (?:above|before)")
_LETTER = re.compile(r"[^\W\d_]")

LONGEST_MEANING = 500
"""Characters kept of one meaning: the most that a world model's file takes for a description."""


@dataclass(frozen=True, slots=True)
class Definition:
    """One sentence of meaning, whether a skill can change it, and the words for the same and for the contrary."""

    meaning: str = ""
    changes: bool = True
    also: tuple[str, ...] = ()
    opposite: tuple[str, ...] = ()


def read_definition(text: str) -> Definition:
    """What stands behind a proposed atom: ``| CHANGES | meaning | also: a, b | opposite: c``, or a part of it.

    Models leave fields out and change their order: words behind ``also`` and ``opposite`` are known by these, a field
    of at most three words that says so tells whether the predicate changes, and the rest is the meaning.
    """
    changes, words = True, dict[str, tuple[str, ...]]()
    meaning: list[str] = []
    for part in (part.strip() for part in text.strip().strip("|").split("|")):
        if related := _RELATED.match(part):
            words[related[1].lower()] = _words(related[2])
        elif len(part.split()) <= 3 and re.search(r"\b(?:changes?|stays?|static|never)\b", part, re.IGNORECASE):
            changes = _STAYS.search(part) is None
        elif part:
            meaning.append(part)
    sentence = " ".join(" ".join(meaning).split())[:LONGEST_MEANING]
    return Definition(sentence, changes, words.get("also", ()), words.get("opposite", ()))


def is_placeholder(meaning: str) -> bool:
    """Whether ``meaning`` fills its place and says nothing: dots, the word "meaning", "as above"."""
    plain = " ".join(re.sub(r"[\W_]+", " ", meaning.lower()).split())
    if not meaning:
        return False
    return _LETTER.search(plain) is None or plain in _PLACEHOLDERS or _ABOVE.fullmatch(plain) is not None


def _words(text: str) -> tuple[str, ...]:
    found = (re.sub(r"[\s\-]+", "_", word.strip(" .`\"'")) for word in text.split(","))
    return tuple(dict.fromkeys(word for word in found if _WORD.match(word)))


def defined_lines(predicates: Iterable[Predicate]) -> str:
    """One line per word, written as a proposal writes it: types, whether a skill changes it, meaning, other words."""
    lines: dict[tuple[str, int, str], list[str]] = {}
    for predicate in sorted(predicates):
        source = predicate.source
        assert isinstance(source, FromVLM), "words are asked of a model"
        said = ["CHANGES" if source.changes else "STAYS", predicate.description or "as the word says"]
        said += [f"also: {', '.join(source.also)}"] if source.also else []
        said += [f"opposite: {', '.join(source.opposite)}"] if source.opposite else []
        key = (source.phrase, predicate.arity, " | ".join(said))
        lines.setdefault(key, []).append(f"({', '.join(t.name for t in predicate.types)})")
    return "\n".join(f"- {word}{', '.join(types)} | {says}" for (word, _, says), types in lines.items())


def meanings_of(atoms: Iterable[Atom]) -> str:
    """The meanings of the predicates of ``atoms``."""
    return meaning_lines({atom.predicate for atom in atoms})


def skill_lines(skills: Iterable[Skill]) -> str:
    """One line per skill: its name, the types of its arguments, and what it does if that is described."""
    distinct = {skill.name: skill for skill in skills}
    return "\n".join(f"- {s}{': ' + s.description if s.description else ''}" for _, s in sorted(distinct.items()))
