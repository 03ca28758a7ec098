"""The one place where a name becomes an object: domains, models behind ``--vlm``, planners, approaches.

Other packages add domains through the entry point group ``pix2pred.domains``; a value is a class without required
arguments that implements ``structs.environment.Domain``. ``pix2pred.approaches`` does the same for objects that
implement ``approach.Approach``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pix2pred.images import ShownPictures
from pix2pred.planning import (
    FF,
    AStar,
    ExternalPlanner,
    GreedyBestFirst,
    Heuristic,
    Planner,
    Portfolio,
    Search,
    Strips,
    TaskPlanner,
    landmark_cut,
)
from pix2pred.planning.external.planner import ENGINES, TIME_LIMIT
from pix2pred.structs import Atom, FromVLM
from pix2pred.structs.environment import Domain, Environment
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.errors import Pix2predError
from pix2pred.vlm import VLM, AnswerStore, FlowSettings, StoredVLM, StoreMode
from pix2pred.vlm.answers.replay import AbsentVLM, replayed
from pix2pred.vlm.control.breaker import BreakerVLM
from pix2pred.vlm.control.budget import BudgetVLM
from pix2pred.vlm.control.estimate import EstimatingVLM
from pix2pred.vlm.control.flow import FlowVLM
from pix2pred.vlm.model_spec import HostedModel, ModelNameError, hosted_model

if TYPE_CHECKING:  # slow to import, and not needed by every verb
    from pix2pred.approaches.approach import Approach
    from pix2pred.execution import TruthOf
    from pix2pred.vlm.offline.model import WordDoc

_DOMAINS = {
    "burger": "pix2pred.domains.burger:BurgerDomain",
    "kitchen": "pix2pred.domains.kitchen:KitchenDomain",
    "coffee": "pix2pred.domains.coffee:CoffeeDomain",
}
_TRUTHS = {
    "burger": "pix2pred.domains.burger.truth:value_now",
    "kitchen": "pix2pred.domains.kitchen.truth:value_now",
    "coffee": "pix2pred.domains.coffee.truth:value_now",
}

_APPROACHES = {
    "ours": "pix2pred.approaches.ours:OURS",
    "vlm-subselect": "pix2pred.approaches.vlm_subselect:VLM_SUBSELECT",
    "no-subselect": "pix2pred.approaches.no_subselect:NO_SUBSELECT",
    "no-invent": "pix2pred.approaches.no_invent:NO_INVENT",
    "no-visual": "pix2pred.approaches.no_visual:NO_VISUAL",
    "no-feature": "pix2pred.approaches.no_feature:NO_FEATURE",
    "vlm-feature-predicates": "pix2pred.approaches.vlm_feature_predicates:VLM_FEATURE_PREDICATES",
    "vila-pure": "pix2pred.approaches.vila_pure:VILA_PURE",
    "vila-fewshot": "pix2pred.approaches.vila_fewshot:VILA_FEWSHOT",
}
"""The approaches of method 9."""

HEURISTICS: dict[str, Callable[[Strips], Heuristic]] = {
    "lmcut": landmark_cut,
    "ff": FF,
}
SEARCHES: dict[str, Callable[[Callable[[Strips], Heuristic]], Search]] = {
    "astar": AStar,
    "gbfs": GreedyBestFirst,
}
"""Every search goes with every heuristic: a planner is called SEARCH-HEURISTIC."""

PORTFOLIOS: dict[str, Callable[[], Search]] = {
    "portfolio": lambda: Portfolio((AStar(max_nodes=5_000), GreedyBestFirst())),
}
"""``portfolio``, the default, plans optimally where that is cheap and greedily otherwise."""


class RegistryError(Pix2predError, ValueError):
    """A name that cannot be turned into what is asked for; the message says what would work."""


def _domains() -> dict[str, str]:
    return {e.name: e.value for e in entry_points(group="pix2pred.domains")} | _DOMAINS


def domain_names() -> tuple[str, ...]:
    """All domains: the bundled ones and those of other packages."""
    return tuple(sorted(_domains()))


def load_domain(name: str) -> Domain:
    """The domain called ``name``. Raises ``UnknownNameError``."""
    found = _domains()
    if name not in found:
        raise UnknownNameError("domain", name, found)
    made: Domain = _load(found[name])()
    return made


def check_family(domain: Domain, family: str) -> None:
    """Raise ``UnknownNameError`` unless ``domain`` has the family."""
    if family not in domain.families:
        raise UnknownNameError("family", family, domain.families)


@dataclass(frozen=True, slots=True)
class Limits:
    """What a run may spend on a hosted model."""

    max_requests: int | None = None
    max_cost: float | None = None


NO_LIMITS = Limits()
_DEFAULT_FLOW = FlowSettings()


def load_vlm(spec: str, domain: str | None, flow: FlowSettings = _DEFAULT_FLOW, limits: Limits = NO_LIMITS) -> VLM:
    """The model that ``--vlm`` names. ``offline`` is the reader of the bundled domain ``domain``."""
    kind, _, rest = spec.partition(":")
    if spec == "offline":
        return _offline(domain)
    if kind == "mailbox" and rest:
        from pix2pred.vlm.mailbox import MailboxVLM

        return MailboxVLM(Path(rest), ShownPictures())
    from pix2pred.vlm.hosted.client import HostedVLM

    hosted = HostedVLM(_hosted(spec), ShownPictures(), flow.timeout)
    flowing = FlowVLM(BudgetVLM(hosted, limits.max_requests, limits.max_cost), flow)
    hosted.hold = flowing.hold
    return BreakerVLM(flowing, flow.unusable_in_a_row)


def load_stored(
    spec: str,
    domain: str | None,
    store: AnswerStore,
    mode: StoreMode = StoreMode.RESUME,
    flow: FlowSettings = _DEFAULT_FLOW,
    limits: Limits = NO_LIMITS,
) -> StoredVLM:
    """The model that ``--vlm`` names, behind an answer store. ``replay:DIR`` brings its own store."""
    kind, _, rest = spec.partition(":")
    if kind == "replay" and rest:
        folder = AnswerStore(Path(rest))
        return StoredVLM(replayed(folder), folder, StoreMode.REPLAY)
    if mode == StoreMode.REPLAY and kind not in ("offline", "mailbox"):
        return StoredVLM(AbsentVLM(_hosted(spec).name), store, mode)  # needs neither key nor network
    return StoredVLM(load_vlm(spec, domain, flow, limits), store, mode)


def _hosted(spec: str) -> HostedModel:
    try:
        return hosted_model(spec)
    except ModelNameError as error:
        raise RegistryError(str(error)) from error


def load_estimator(spec: str, domain: str | None, store: AnswerStore) -> EstimatingVLM:
    """What counts the questions that ``spec`` would be asked, for which neither key nor network is needed."""
    kind, _, rest = spec.partition(":")
    if kind in ("offline", "replay", "mailbox"):
        return EstimatingVLM(load_stored(spec, domain, store, StoreMode.REPLAY), "", "")
    return EstimatingVLM(load_stored(spec, domain, store, StoreMode.REPLAY), kind, rest.partition("@http")[0])


def _offline(domain: str | None) -> VLM:
    reader = load_domain(domain).reader if domain else None
    if reader is None:
        raise RegistryError("the offline reader knows only the bundled domains; name a model with --vlm for your data")
    from pix2pred.vlm.offline.model import ReaderModel
    from pix2pred.vlm.offline.reader import OfflineReader

    return OfflineReader(str(domain), ReaderModel.load(reader))


def load_planner(name: str, *, distinct: bool = True, time_limit: float = TIME_LIMIT) -> TaskPlanner:
    """The planner called ``name``: a search of ours or an engine of others.

    ``distinct`` parameters stand for distinct objects; ``time_limit`` in seconds binds external engines alone. Raises
    ``UnknownNameError``, or ``ExternalPlannerError`` for an engine that is not installed.
    """
    if name in ENGINES:
        return ExternalPlanner(name, distinct, time_limit)
    if name in PORTFOLIOS:
        return Planner(PORTFOLIOS[name](), distinct=distinct)
    search, _, heuristic = name.partition("-")
    if search not in SEARCHES or heuristic not in HEURISTICS:
        raise UnknownNameError("planner", name, (*planner_names(), *ENGINES))
    return Planner(SEARCHES[search](HEURISTICS[heuristic]), distinct=distinct)


def planner_names() -> tuple[str, ...]:
    """The names of all planners of our own, for ``load_planner``."""
    return (*(f"{search}-{heuristic}" for search in SEARCHES for heuristic in HEURISTICS), *PORTFOLIOS)


def word_truth(domain: Domain, environment: Environment) -> TruthOf | None:
    """What the simulator knows about the reader's words in the environment's present state, to name failures with."""
    if domain.name not in _TRUTHS or domain.reader is None:
        return None
    uses = _word_uses(domain.reader)
    value: Callable[[Environment, str, Sequence[str]], bool] = _load(_TRUTHS[domain.name])

    def truth(atom: Atom) -> bool | None:
        source = atom.predicate.source
        phrase = source.phrase if isinstance(source, FromVLM) else ""
        word = uses.get((phrase, tuple(o.type.name for o in atom.objects)))
        if word is None or word.concept is None:
            return None
        return value(environment, word.concept, [o.name for o in atom.objects]) != word.negated

    return truth


@cache
def _word_uses(reader: Path) -> dict[tuple[str, tuple[str, ...]], WordDoc]:
    from pix2pred.vlm.offline.model import load_words

    return {(word.word, types): word for word, types in load_words(reader).uses()}


def load_approach(name: str) -> Approach:
    """The approach called ``name``. Raises ``UnknownNameError``."""
    found = {e.name: e.value for e in entry_points(group="pix2pred.approaches")} | _APPROACHES
    if name not in found:
        raise UnknownNameError("approach", name, found)
    made: Approach = _load(found[name])
    return made


class Names:
    """Names to objects, for workers that look them up themselves; see ``benchmark.cells.Catalogue``."""

    def domain(self, name: str) -> Domain:
        return load_domain(name)

    def vlm(self, spec: str, domain: str | None) -> VLM:
        return load_vlm(spec, domain)

    def approach(self, name: str) -> Approach:
        return load_approach(name)

    def truth(self, domain: Domain, environment: Environment) -> TruthOf | None:
        return word_truth(domain, environment)


def _load(target: str) -> Any:
    module, _, attribute = target.partition(":")
    return getattr(import_module(module), attribute)
