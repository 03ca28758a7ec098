"""The YAML that is read and written: lines, the values of plain words, hostile input."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.demos.files.yaml_lines import YamlError, parse_yaml
from pix2pred.demos.files.yaml_text import dump_yaml

SCALARS = (
    st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.floats(allow_nan=False) | st.text(max_size=20)
    | st.sampled_from(["On", "off", "y", "1e3", "0x1F", "2024-01-01", "~", "", "- a", "a: b", "<<", "\x85\u2028"])
)  # fmt: skip
KEYS = st.text(min_size=1, max_size=10).filter(lambda key: key < "\ud800" or key > "\udfff")
DATA = st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=12) | st.dictionaries(KEYS, inner), max_leaves=15)


@settings(max_examples=100, deadline=None)
@given(st.dictionaries(KEYS, DATA, min_size=1))
def test_what_is_written_reads_back(data: dict[str, object]) -> None:
    assert parse_yaml(dump_yaml(data).encode()).data == data


def test_long_lists_are_wrapped_between_entries() -> None:
    text = dump_yaml({"given": [f"On(patty{i}, patty{i + 1})" for i in range(40)]})
    assert max(map(len, text.splitlines())) <= 112
    assert all(line.count('"') % 2 == 0 for line in text.splitlines())


def test_what_yaml_has_no_word_for_is_not_written() -> None:
    for data in ({"a": {1, 2}}, {1: "a"}, {"a": b"bytes"}):
        with pytest.raises(TypeError):
            dump_yaml(data)  # type: ignore[arg-type]


def test_lines_are_those_of_the_file() -> None:
    lined = parse_yaml(b"# note\na: 1\nb:\n  - x\n  - {c: [2,\n     3]}\n\nd:\n  e: f\n")
    places = {("a",): 2, ("b",): 3, ("b", 0): 4, ("b", 1, "c", 1): 6, ("d", "e"): 9, ("d", "missing"): 8, ("zz",): 2}
    assert {loc: lined.line(loc) for loc in places} == places


def test_words_stay_words() -> None:
    data = parse_yaml(b"{On: On, no: no, 1: 2024-01-01, t: [true, ~, 1_000, 0x10, .inf, 1e3, '5', +7]}").data
    assert data == {
        "On": "On", "no": "no", "1": "2024-01-01", "t": [True, None, "1_000", "0x10", math.inf, 1000.0, "5", 7],
    }  # fmt: skip


HOSTILE = {
    b"": (1, "empty"),
    b"# nothing\n": (1, "empty"),
    b"a: 1\nb: \xff\xfe\n": (2, "UTF-8"),
    "a: 1".encode("utf-16"): (1, "UTF-8"),
    b"\x00\x01\x02": (1, "not valid YAML"),
    b"a: 1\nb: \x07\n": (2, "not valid YAML"),
    b"a:\n\t- b\n": (2, "tabs"),
    b"a: 1\na: 2\n": (2, "twice"),
    b"x:\n  - {k: 1,\n     k: 2}\n": (3, "twice"),
    b"a: &x 1\nb: *x\n": (1, "anchors"),
    b"a: 1\nb: *x\n": (2, "aliases"),
    b"a: !!python/object/apply:os.system ['true']\n": (1, "tags"),
    b"a: !!binary aGk=\n": (1, "tags"),
    b"--- a\n--- b\n": (2, "several"),
    b"? [a, b]\n: c\n": (1, "key must be text"),
    b"a: [1, 2\nb: 3\n": (2, "not valid YAML"),
    b"a: b: c\n": (1, "quotes"),
    b"a: '\n": (2, "not valid YAML"),
    b"[" * 200_000: (1, "nest"),
    b"a: " + b"9" * 5000: (1, "digits"),
    b"- " * 200_000: (1, "nest"),
    b"a" * 9_000_000: (1, "bytes"),
    b"- a\n" * 250_000: (None, "entries"),
}


@pytest.mark.parametrize("content", HOSTILE, ids=lambda content: repr(content[:16]))
def test_hostile_input_is_refused_with_its_line(content: bytes) -> None:
    line, message = HOSTILE[content]
    with pytest.raises(YamlError, match=message) as caught:
        parse_yaml(content)
    assert line is None or caught.value.line == line


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=200) | st.text(alphabet="[]{}:,-?&*!|>'\"#%@` \n\tab1~", max_size=60).map(str.encode))
def test_any_bytes_give_data_or_an_error(content: bytes) -> None:
    try:
        parse_yaml(content)
    except YamlError as error:
        assert 1 <= error.line <= content.count(b"\n") + content.count(b"\r") + 3
