"""The dry run against what is spent, through ``learn``: a model that thinks, cuts, refuses, forgets; and going on."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cli.hostile_lamps import write_lamps
from command_line import Cli
from pix2pred.vlm.hosted.pricing import dollars
from vlm.fault_server import FaultServer, lines, text
from vlm.odd_server import Reply, Scripted, said, thinking

FAST = "flow: {first_pause: 0, longest_pause: 0, tries: 3, timeout: 60, concurrent: 8%s}\n"
SPECS = ("openai-compatible:tiny@{url}", "openai:gpt-4o", "openai:o4-mini")


class Ledger(Scripted):
    """A server that adds up what it answers: questions, tokens and, as ``openai:gpt-4o`` or the like, dollars."""

    def __init__(self, reply: Callable[[dict[str, Any]], Reply]) -> None:
        super().__init__(self._adding(reply))
        self.questions, self.read, self.written = 0, 0, 0

    def _adding(self, reply: Callable[[dict[str, Any]], Reply]) -> Callable[[dict[str, Any]], Reply]:
        def adding(body: dict[str, Any]) -> Reply:
            status, document = reply(body)
            if status == 200:
                with self._one:
                    self.questions += 1
                    self.read += document["usage"]["prompt_tokens"]
                    self.written += document["usage"]["completion_tokens"]
            return status, document

        return adding

    def spent(self, spec: str, counted: dict[str, Any]) -> float:
        """The largest share of the dry run ``counted`` that was spent: of questions, and of dollars or tokens."""
        price = dollars("openai", spec.removeprefix("openai:"), self.read, self.written)
        money: float = self.written / counted["output_tokens"]
        if spec.startswith("openai:"):
            assert price is not None
            money = price / counted["dollars"]
        questions: float = self.questions / counted["queries"]
        return max(money, questions)


def sensible(body: dict[str, Any]) -> str:
    return "\n".join(lines(body))


def thinks(tokens: int) -> Callable[[dict[str, Any]], Reply]:
    return lambda body: thinking(tokens, sensible(body))(body)


def thinks_at_times(body: dict[str, Any]) -> Reply:
    return thinks(random.Random(text(body)).choice((0, 200, 3000, 14_000)))(body)


def cuts(body: dict[str, Any]) -> Reply:
    return said(sensible(body)[:7], "length", 400)


def refuses(body: dict[str, Any]) -> Reply:
    return said("", "content_filter", 5) if random.Random(str(body)).random() < 0.6 else said(sensible(body))


def forgets(body: dict[str, Any]) -> Reply:
    return said("\n".join(lines(body)[:1]), tokens=300)


def invents(body: dict[str, Any]) -> Reply:
    """A hundred predicates where eight of a kind are assumed."""
    if "\nPredicates:\n" in text(body):
        return said(sensible(body), tokens=1200)
    return said("\n".join(f"* look_{n}(l1)" for n in range(100)))


FAULTS: dict[str, Callable[[dict[str, Any]], Reply]] = {
    **{f"thinks {tokens}": thinks(tokens) for tokens in (300, 3000, 16_000, 90_000)},
    "thinks at times": thinks_at_times,
    "cuts": cuts,
    "refuses": refuses,
    "forgets": forgets,
    "invents": invents,
}


@pytest.fixture(scope="module")
def lamps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_lamps(tmp_path_factory.mktemp("lamps") / "project", demos=3)


@pytest.mark.parametrize(
    ("fault", "spec"),
    [
        *((fault, SPECS[n % 3]) for n, fault in enumerate(FAULTS)),
        ("thinks 300", SPECS[1]),
        ("thinks 3000", SPECS[0]),
        ("thinks 90000", SPECS[1]),
        ("invents", SPECS[0]),
    ],
)
def test_never_more_than_three_times_the_dry_run_is_spent(
    cli: Cli, lamps: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str, spec: str
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-not-a-key-000000")
    quick = tmp_path / "quick.yaml"
    quick.write_text(FAST % "")
    with Ledger(FAULTS[fault]).running() as server:
        monkeypatch.setenv("OPENAI_BASE_URL", server.url)
        told = ("learn", lamps, "--vlm", spec.format(url=server.url), "--config", quick, "--out", tmp_path / "run")
        counted = cli(*told, "--dry-run", "--json").json
        ran = cli(*told)
        assert isinstance(server, Ledger) and server.spent(spec, counted) <= 3
        assert ran.code in (0, 1, 2) and "Traceback" not in ran.err
        if ran.code == 1 and "a dry run said" in ran.err:
            assert "the same command goes on" in " ".join(ran.err.split())


@pytest.mark.parametrize("tokens", [3000, 6000, 14_000])
def test_a_run_that_was_stopped_goes_on_where_it_stopped(cli: Cli, lamps: Path, tmp_path: Path, tokens: int) -> None:
    quick = tmp_path / "quick.yaml"
    quick.write_text(FAST % "")
    with Ledger(thinks(tokens)).running() as server:
        assert isinstance(server, Ledger)
        told = ("learn", lamps, "--vlm", f"openai-compatible:tiny@{server.url}", "--config", quick)
        stopped = cli(*told, "--out", tmp_path / "run")
        assert stopped.code == 1 and "flow: {thinking: TOKENS}" in " ".join(stopped.err.split())
        quick.write_text(FAST % f", thinking: {tokens + 500}")
        left = cli(*told, "--out", tmp_path / "run", "--dry-run", "--json").json
        server.questions = 0
        gone_on = cli(*told, "--out", tmp_path / "run", "--json")
        assert gone_on.code == 0, gone_on.err
        assert server.questions == left["queries"] - left["from_store"]
        with FaultServer().running() as calm:
            whole = ("learn", lamps, "--vlm", f"openai-compatible:tiny@{calm.url}", "--out", tmp_path / "calm")
            assert cli(*whole).code == 0
    labels = [(tmp_path / run / "labels/traces.json").read_bytes() for run in ("run", "calm")]
    assert labels[0] == labels[1]
