"""The one place where a name becomes an object: domains, models behind ``--vlm``, planners, approaches.

Other packages add to each table through an entry point of the group named beside it; ``docs/extending.md`` shows one of
each. A command takes one ``Registry`` and asks it for everything, so that tests and other programs pass their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pix2pred.images import ShownPictures
from pix2pred.planners import Planners
from pix2pred.structs import Atom, FromVLM, Label
from pix2pred.structs.environment import Domain, Environment, KnowsTruth
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.installed import load, named
from pix2pred.vlm import VLM, AnswerStore, FlowSettings, StoredVLM, StoreMode
from pix2pred.vlm.answers.replay import REPLAY
from pix2pred.vlm.control.estimate import EstimatingVLM
from pix2pred.vlm.hosted.anthropic import Anthropic
from pix2pred.vlm.hosted.google import Google
from pix2pred.vlm.hosted.openai import OpenAI
from pix2pred.vlm.hosted.openai_compatible import OpenAICompatible
from pix2pred.vlm.hosted.provider import Provider
from pix2pred.vlm.hosted.spec import kind_of
from pix2pred.vlm.mailbox import MAILBOX
from pix2pred.vlm.model_spec import Kind, MadeSpec, ModelSpec, Setup, Spending, read_model
from pix2pred.vlm.offline.spec import OFFLINE

if TYPE_CHECKING:  # slow to import, and not needed by every verb
    from pix2pred.approaches.approach import Approach
    from pix2pred.execution import TruthOf
    from pix2pred.vlm.offline.model import WordDoc

_DOMAINS = {
    "burger": "pix2pred.domains.burger:BurgerDomain",
    "kitchen": "pix2pred.domains.kitchen:KitchenDomain",
    "coffee": "pix2pred.domains.coffee:CoffeeDomain",
    "cleanup": "pix2pred.domains.cleanup:CleanupDomain",
    "juice": "pix2pred.domains.juice:JuiceDomain",
}
"""Classes without required arguments that implement ``Domain``; group ``pix2pred.domains``."""

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
"""The approaches of method 9: objects that implement ``Approach``; group ``pix2pred.approaches``."""

_PROVIDERS: tuple[Provider, ...] = (OpenAI(), Google(), Anthropic(), OpenAICompatible())
"""Providers of hosted models; group ``pix2pred.providers`` for classes without required arguments."""

_DISTILLED = "pix2pred.vlm.distilled.spec"
_CASCADE_FORM = "cascade:READER,MODEL"

_KINDS: dict[str, Kind] = {
    "offline": OFFLINE,
    **{p.name: kind_of(p) for p in _PROVIDERS},
    "replay": REPLAY,
    "mailbox": MAILBOX,
    "reader": Kind("reader:DIR", lambda rest: load(f"{_DISTILLED}:ReaderSpec")(Path(rest))),
}
"""Kinds of models; group ``pix2pred.models`` for functions of what follows ``KIND:`` that give a ``VLM``."""
MODEL_FORMS = ", ".join((*(kind.form for kind in _KINDS.values()), _CASCADE_FORM))
"""How the models that come along are written, for help texts."""

NO_LIMITS = Spending()
_DEFAULT_FLOW = FlowSettings()


class Registry(Planners):
    """Names to objects. Survives pickling, so that workers can look names up themselves."""

    def domain_names(self) -> tuple[str, ...]:
        """All domains: the bundled ones and those of other packages."""
        return tuple(sorted(named("domains", _DOMAINS)))

    def domain(self, name: str) -> Domain:
        """The domain called ``name``. Raises ``UnknownNameError``."""
        made: Domain = _find("domain", name, named("domains", _DOMAINS))()
        return made

    def approach(self, name: str) -> Approach:
        """The approach called ``name``. Raises ``UnknownNameError``."""
        made: Approach = _find("approach", name, named("approaches", _APPROACHES))
        return made

    def providers(self) -> tuple[Provider, ...]:
        """All providers of hosted models."""
        return (*_PROVIDERS, *(load(target)() for target in named("providers", {}).values()))

    def others(self, kind: str, group: str, ours: dict[str, str], name: str) -> Any:
        """What ``name`` means in a table of ours or of the entry points ``group``. Raises ``UnknownNameError``."""
        return _find(kind, name, named(group, ours))

    def model_spec(self, text: str) -> ModelSpec:
        """The model that ``--vlm`` names. Raises ``ModelNameError`` with the forms there are."""
        others = {kind: Kind(f"{kind}:...", MadeSpec.by(load(made))) for kind, made in named("models", {}).items()}
        kinds = others | {p.name: kind_of(p) for p in self.providers()} | _KINDS
        cascade = Kind(_CASCADE_FORM, lambda rest: load(f"{_DISTILLED}:read_cascade")(rest, self.model_spec, _said))
        return read_model(text, kinds | {"cascade": cascade})

    def vlm(
        self, spec: str, domain: str | None, flow: FlowSettings = _DEFAULT_FLOW, limits: Spending = NO_LIMITS
    ) -> VLM:
        """The model that ``--vlm`` names. ``offline`` is the reader of the bundled domain ``domain``."""
        return self.model_spec(spec).connect(self._setup(domain, flow, limits))

    def writes(self, spec: str) -> bool:
        """Whether the model that ``--vlm`` names writes plans and code as well as labels."""
        return self.model_spec(spec).writes

    def stored(
        self,
        spec: str,
        domain: str | None,
        store: AnswerStore,
        mode: StoreMode = StoreMode.RESUME,
        flow: FlowSettings = _DEFAULT_FLOW,
        limits: Spending = NO_LIMITS,
    ) -> VLM:
        """The model that ``--vlm`` names, behind an answer store. ``replay:DIR`` brings its own store.

        Of a cascade the large model's answers are stored; what its reader says is read anew.
        """
        setup = self._setup(domain, flow, limits)
        return self.model_spec(spec).around(setup, lambda model: _stored(model, setup, store, mode))

    def estimator(
        self, spec: str, domain: str | None, store: AnswerStore, flow: FlowSettings = _DEFAULT_FLOW
    ) -> EstimatingVLM:
        """What counts the questions that ``spec`` would be asked, for which neither key nor network is needed."""
        model, setup = self.model_spec(spec), self._setup(domain, flow, NO_LIMITS)
        return EstimatingVLM(
            lambda counted: model.around(setup, lambda m: counted(_stored(m, setup, store, StoreMode.REPLAY))),
            model.rates,
            flow.thinking,
        )

    def _setup(self, domain: str | None, flow: FlowSettings, limits: Spending) -> Setup:
        reader = self.domain(domain).reader if domain else None
        return Setup(ShownPictures(), flow, limits, domain or "", reader)

    def truth(self, domain: Domain, environment: Environment) -> TruthOf | None:
        """What ``domain`` knows about words in the environment's present state, to name failures with."""
        if not isinstance(domain, KnowsTruth):
            return None
        uses = _word_uses(domain.reader) if domain.reader is not None else None

        def truth(atom: Atom) -> bool | None:
            phrase = atom.predicate.source.phrase if isinstance(atom.predicate.source, FromVLM) else ""
            names = [o.name for o in atom.objects]
            if uses is None:
                return domain.concept_holds(environment, phrase, names)
            word = uses.get((phrase, tuple(o.type.name for o in atom.objects)))
            if word is None or word.concept is None:
                return None
            holds = domain.concept_holds(environment, word.concept, names)
            return None if holds is None else holds != word.negated

        return truth


REGISTRY = Registry()
"""What is installed; whoever is given no other registry uses this one."""

load_domain, load_approach, load_planner = REGISTRY.domain, REGISTRY.approach, REGISTRY.planner
load_vlm, load_stored, planner_names = REGISTRY.vlm, REGISTRY.stored, REGISTRY.planner_names


def _stored(model: ModelSpec, setup: Setup, store: AnswerStore, mode: StoreMode) -> StoredVLM:
    """One model behind a store."""
    if model.own_answers is not None:
        return StoredVLM(model.connect(setup), AnswerStore(model.own_answers), StoreMode.REPLAY)
    return StoredVLM((model.by_name if mode == StoreMode.REPLAY else model.connect)(setup), store, mode)


def _said(answer: str, atoms: Sequence[str]) -> dict[str, bool]:
    """The values that a model's answer gives to atoms, in words or as JSON."""
    from pix2pred.predicates.labelling.label_format import LabelFormat

    values = LabelFormat().read(answer, atoms).values
    return {atom: value == Label.TRUE for atom, value in values.items() if value != Label.UNKNOWN}


def check_family(domain: Domain, family: str) -> None:
    """Raise ``UnknownNameError`` unless ``domain`` has the family."""
    if family not in domain.families:
        raise UnknownNameError("family", family, domain.families, listed=True)


def _find(kind: str, name: str, table: dict[str, str]) -> Any:
    if name not in table:
        raise UnknownNameError(kind, name, table, listed=True)
    return load(table[name])


@cache
def _word_uses(reader: Path) -> dict[tuple[str, tuple[str, ...]], WordDoc]:
    from pix2pred.vlm.offline.model import load_words

    return {(word.word, types): word for word, types in load_words(reader).uses()}
