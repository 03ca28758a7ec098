"""Print what the offline reader of a domain claims to read, and how well, as Markdown.

python tools/describe_reader.py burger > docs/burger_reader.md
"""

from __future__ import annotations

import argparse
import json

from pix2pred.registry import load_domain
from pix2pred.vlm.offline.model import WordDoc, load_words

HEAD = """# The offline reader of the {domain} domain

Written by `python tools/describe_reader.py {domain}` from the reader's word list and card; the card is written by
`python tools/train_reader.py {domain}`. The same figures are measured again, on seeds used nowhere else, by
`pytest {tests}`.

Reader `{digest}`, trained on {pictures} rendered pictures (seed 7001), measured on renders of seed 7002. Balanced
accuracy; `Unknown` counts as wrong.
"""

HIDDEN = """
An object that is hidden in a picture has no box there: all words about it are answered `Unknown`, which happened in
{hidden} of {cases} cases; they are not in the table. Of the cases in the table {unknown:.2%} were answered `Unknown`.
"""

DISTRACTORS = """
The other words are distractors: they say True when one number exceeds a threshold, whatever the word means.
"""


def kinds(word: WordDoc) -> str:
    return ", ".join("(" + ", ".join(types) + ")" for types in word.types)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("domain")
    domain = load_domain(parser.parse_args().domain)
    assert domain.reader is not None, "the domain has no reader"
    card = json.loads((domain.reader / "card.json").read_text())
    words = load_words(domain.reader).words
    shared = {"burger": "tests/vlm/test_reader.py"} | dict.fromkeys(
        ("cleanup", "juice"), "tests/domains/home/test_reader.py"
    )
    tests = shared.get(domain.name, f"tests/domains/{domain.name}/test_reader.py")
    print(HEAD.format(domain=domain.name, digest=card["digest"][:12], pictures=card["training_pictures"], tests=tests))
    print("| word | arguments | reads | balanced accuracy | true cases | false cases |")
    print("|---|---|---|---|---|---|")
    for word in (w for w in words if w.concept is not None):
        row = card["words"][word.word]
        reads = f"not {word.concept}" if word.negated else word.concept
        accuracy = f"{row['balanced_accuracy']:.2%}"
        print(f"| {word.word} | {kinds(word)} | {reads} | {accuracy} | {row['true_cases']} | {row['false_cases']} |")
    rows = card["words"].values()
    if all("hidden_cases" in row for row in rows):
        seen = sum(row["true_cases"] + row["false_cases"] for row in rows)
        hidden = sum(row["hidden_cases"] for row in rows)
        unknown = sum(row["unknown_share"] * (row["true_cases"] + row["false_cases"]) for row in rows) / seen
        print(HIDDEN.format(hidden=hidden, cases=hidden + seen, unknown=unknown))
    print(DISTRACTORS)
    print("| word | arguments | measures | threshold |")
    print("|---|---|---|---|")
    for word in (w for w in words if w.measure is not None):
        print(f"| {word.word} | {kinds(word)} | {word.measure} | {word.above:g} |")


if __name__ == "__main__":
    main()
