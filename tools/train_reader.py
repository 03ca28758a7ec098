"""Train the offline reader of a domain from rendered pictures, and measure it on pictures it never saw.

    python tools/train_reader.py burger

Writes ``weights.npz`` and ``card.json`` into the domain's ``reader/`` folder. The scenes come from seeds used for
nothing else: 7001 for training, 7002 for the card's accuracies (tests use 7003).

Beside it a domain has a module of ``random_worlds`` (``random_worlds(seed, looks, per_look)``), and brings ``render``
(``render(world)``) and ``truth`` (``concept_value(world, concept, names)``). Its worlds have ``types()``. Where worlds
are costly, or seen by several cameras, that of ``random_worlds`` has ``worlds_of_look(seed, look, per_look)`` and
``views(world)`` instead, and no ``render`` is needed.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import PIL.Image
from joblib import Parallel, delayed
from numpy.typing import NDArray
from scipy.linalg import block_diag
from sklearn.decomposition import PCA
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier

from pix2pred.structs import Image, Picture
from pix2pred.vlm.offline.model import WEIGHTS, Projection, ReaderModel, WordListDoc, inputs, load_words
from pix2pred.vlm.offline.pixels import Scene

TRAINING_SEED, CARD_SEED = 7001, 7002
HIDDEN = 20
MOST_SAMPLES = 8000
SHRINKAGE = 1.0
"""Weight decay of the networks: of 0.01, 1, 10 and 30, this one reads most of what it never saw (60 looks of Juice)."""

Signature = tuple[str, ...]
Views = Callable[[Any], Sequence[Picture]]


class World(Protocol):
    """What training needs of a domain's world."""

    def types(self) -> Mapping[str, str]:
        """Type names of all objects by name."""
        ...


RENDERING = {"burger": "drawing.render", "kitchen": "render", "coffee": "simulation.render"}
"""The module of a domain that draws its worlds."""


def part_of(domain: str, module: str) -> Any:
    """A module of a domain."""
    return import_module(f"pix2pred.domains.{domain}.{module}")


def worlds_of(domain: str) -> Any:
    """The module that makes random worlds of a domain."""
    return import_module(f"random_worlds.{domain}")


def folder_of(domain: str) -> Path:
    """Where a domain keeps its reader."""
    return Path(str(part_of(domain, "truth").__file__)).parent / "reader"


@dataclass(frozen=True)
class Case:
    """A concept asked about objects of one world."""

    world: int
    names: tuple[str, ...]
    truth: bool


def render_worlds(words: WordListDoc, worlds: Sequence[World], views: Views) -> tuple[list[World], list[Scene]]:
    """A scene for every picture of every world, and the world of every scene."""
    seen = [(world, words.scene(picture, world.types())) for world in worlds for picture in views(world)]
    scenes = [scene for _, scene in seen]
    for scene in scenes:
        for name in scene.picture.boxes:
            scene.crops(name)
        scene.image = PIL.Image.new("L", scene.image.size)  # only the size is needed once the crops are taken
        scene.picture = Picture(scene.picture.camera, Image(b""), scene.picture.boxes)
    return [world for world, _ in seen], scenes


def render_look(domain: str, words: WordListDoc, seed: int, look: int, per_look: int) -> Any:
    """The pictures of one look of a domain that draws its worlds look by look."""
    module = worlds_of(domain)
    return render_worlds(words, module.worlds_of_look(seed, look, per_look), module.views)


def read_worlds(domain: str, seed: int, looks: int, per_look: int, jobs: int) -> tuple[list[World], list[Scene]]:
    words, module = load_words(folder_of(domain)), worlds_of(domain)
    run = Parallel(n_jobs=jobs)
    if hasattr(module, "worlds_of_look"):
        seen = run(delayed(render_look)(domain, words, seed, look, per_look) for look in range(looks))
    else:
        render = part_of(domain, RENDERING[domain]).render
        worlds = module.random_worlds(seed, looks, per_look)
        chunks = [worlds[i : i + per_look] for i in range(0, len(worlds), per_look)]
        seen = run(delayed(render_worlds)(words, chunk, lambda world: (render(world),)) for chunk in chunks)
    return [w for worlds, _ in seen for w in worlds], [s for _, scenes in seen for s in scenes]


def cases(
    domain: str, worlds: Sequence[World], concept: str, signature: Signature, rng: np.random.Generator
) -> list[Case]:
    """All cases of a concept, at most MOST_SAMPLES / 2 of each truth value."""
    concept_value = part_of(domain, "truth").concept_value
    found: dict[bool, list[Case]] = {True: [], False: []}
    for w, world in enumerate(worlds):
        by_type: dict[str, list[str]] = {}
        for name, type_name in sorted(world.types().items()):
            by_type.setdefault(type_name, []).append(name)
        for a in by_type.get(signature[0], []):
            rest = [(b,) for b in by_type.get(signature[1], []) if b != a] if len(signature) == 2 else [()]
            for others in rest:
                names = (a, *others)
                truth = concept_value(world, concept, names)
                found[truth].append(Case(w, names, truth))
    kept = []
    for group in found.values():
        order = rng.permutation(len(group))[: MOST_SAMPLES // 2]
        kept += [group[i] for i in order]
    return kept


def fit_projections(scenes: Sequence[Scene], worlds: Sequence[World]) -> dict[str, Projection]:
    crops: dict[str, list[NDArray[np.float32]]] = {}
    for scene, world in zip(scenes, worlds, strict=True):
        for name, type_name in sorted(world.types().items()):
            vector = scene.crops(name)
            if vector is not None:
                crops.setdefault(type_name, []).append(vector)
    fitted, sight = {}, type(scenes[0])
    for type_name, rows in sorted(crops.items()):
        split = np.split(np.stack(rows[:6000]), np.cumsum(sight.blocks)[:-1], axis=1)
        parts = [PCA(n, random_state=0).fit(x) for n, x in zip(sight.components, split, strict=True)]
        # rounded as they will be stored, so that training and use see the same codes
        mean = np.concatenate([p.mean_ for p in parts]).astype(np.float16)
        components = block_diag(*(p.components_ for p in parts)).astype(np.float16)
        fitted[type_name] = Projection(mean.astype(np.float32), components.astype(np.float32))
    return fitted


def fit(x: NDArray[np.float32], y: NDArray[np.bool_]) -> dict[str, NDArray[np.float32]]:
    mean, scale = x.mean(axis=0), np.maximum(x.std(axis=0), 1e-3)
    if y.all() or not y.any():
        only = 10.0 if y.all() else -10.0
        w1, b1, w2, b2 = np.zeros((x.shape[1], 1)), np.zeros(1), np.zeros((1, 1)), np.array([only])
    else:
        network = MLPClassifier((HIDDEN,), alpha=SHRINKAGE, max_iter=120, learning_rate_init=3e-3, random_state=0)
        weights = np.where(y, len(y) / (2 * y.sum()), len(y) / (2 * (~y).sum()))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            network.fit((x - mean) / scale, y, sample_weight=weights)
        (w1, w2), (b1, b2) = network.coefs_, network.intercepts_
    arrays = {"mean": mean, "scale": scale, "w1": w1, "b1": b1, "w2": w2, "b2": b2}
    return {key: np.asarray(value, dtype=np.float32) for key, value in arrays.items()}


def visible(case: Case, scenes: Sequence[Scene]) -> bool:
    """Whether all objects of a case are seen."""
    return all(scenes[case.world].crops(name) is not None for name in case.names)


def states(worlds: Sequence[World], scenes: Sequence[Scene]) -> list[tuple[World, list[Scene]]]:
    """Every world with all the pictures of it, which follow one another."""
    grouped: list[tuple[World, list[Scene]]] = []
    for world, scene in zip(worlds, scenes, strict=True):
        if not grouped or grouped[-1][0] is not world:
            grouped.append((world, []))
        grouped[-1][1].append(scene)
    return grouped


def measure(
    domain: str, model: ReaderModel, worlds: Sequence[World], scenes: Sequence[Scene]
) -> dict[str, dict[str, float]]:
    """Per word over all its signatures: balanced accuracy, where Unknown counts as wrong, and the share of Unknown.

    All pictures of a state are read together, as a labeller asks. Cases about an object that none of them shows are
    counted apart; the share of them answered Unknown must be all.
    """
    rng = np.random.default_rng(1)
    grouped = states(worlds, scenes)
    hidden: dict[str, list[bool]] = {}
    unknown: dict[str, list[bool]] = {}
    right: dict[str, dict[bool, list[int]]] = {}
    for word, signature in model.words.uses():
        if word.concept is None:
            continue
        for case in cases(domain, [world for world, _ in grouped], word.concept, signature, rng):
            truth = case.truth != word.negated
            seeing = [s for s in grouped[case.world][1] if all(s.crops(name) is not None for name in case.names)]
            value, _ = model.joint_value(word.word, case.names, signature, seeing)
            if not seeing:
                hidden.setdefault(word.word, []).append(value is None)
                continue
            unknown.setdefault(word.word, []).append(value is None)
            right.setdefault(word.word, {True: [], False: []})[truth].append(value == truth)
    return {
        word: {
            "balanced_accuracy": round(float(np.mean([np.mean(v) if v else 1.0 for v in by_truth.values()])), 4),
            "true_cases": len(by_truth[True]),
            "false_cases": len(by_truth[False]),
            "unknown_share": round(float(np.mean(unknown[word])), 4),
            "hidden_cases": len(hidden.get(word, [])),
            "hidden_unknown_share": round(float(np.mean(hidden[word])), 4) if word in hidden else 1.0,
        }
        for word, by_truth in sorted(right.items())
    }


def train(domain: str, directory: Path, looks: int, jobs: int) -> int:
    """Fit the classifiers and write their weights; gives the number of pictures they are trained on."""
    words = load_words(directory)
    start = time.perf_counter()
    worlds, scenes = read_worlds(domain, TRAINING_SEED, looks, 5, jobs)
    print(f"{len(worlds)} pictures rendered in {time.perf_counter() - start:.0f} s", flush=True)
    projections = fit_projections(scenes, worlds)
    print(f"projections fitted, {time.perf_counter() - start:.0f} s", flush=True)
    rng = np.random.default_rng(0)
    keys = sorted({(w.concept, types) for w, types in words.uses() if w.concept is not None})
    samples = []
    for concept, signature in keys:
        chosen = [c for c in cases(domain, worlds, concept, signature, rng) if visible(c, scenes)]
        x = np.stack([inputs(scenes[c.world], projections, c.names, signature) for c in chosen])
        samples.append((x, np.array([c.truth for c in chosen])))
    print(f"{sum(len(y) for _, y in samples)} samples, {time.perf_counter() - start:.0f} s", flush=True)
    fitted = Parallel(n_jobs=jobs)(delayed(fit)(x, y) for x, y in samples)
    arrays: dict[str, NDArray[np.generic]] = {}
    for type_name, p in projections.items():
        arrays[f"projection|{type_name}|mean"] = p.mean.astype(np.float16)
        arrays[f"projection|{type_name}|components"] = p.components.astype(np.float16)
    for (concept, signature), parts in zip(keys, fitted, strict=True):
        for part, array in parts.items():
            arrays["|".join(("classifier", concept, *signature, part))] = array
    np.savez_compressed(directory / WEIGHTS, **arrays)  # type: ignore[arg-type]
    return len(worlds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("domain", choices=["burger", "cleanup", "coffee", "juice", "kitchen"])
    parser.add_argument("--looks", type=int, default=550, help="differently drawn scenes")
    parser.add_argument("--card-looks", type=int, default=60, help="differently drawn scenes for the card")
    parser.add_argument("--card-only", action="store_true", help="measure the weights that are there")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    domain = str(arguments.domain)
    directory = folder_of(domain)
    start = time.perf_counter()
    if arguments.card_only:
        pictures = json.loads((directory / "card.json").read_text())["training_pictures"]
    else:
        pictures = train(domain, directory, arguments.looks, arguments.jobs)
    model = ReaderModel.load(directory)
    card = {
        "what": "balanced accuracy per word on states from seed 7002, all pictures of each; Unknown counts as wrong",
        "digest": model.digest,
        "training_pictures": pictures,
        "words": measure(domain, model, *read_worlds(domain, CARD_SEED, arguments.card_looks, 4, arguments.jobs)),
    }
    (directory / "card.json").write_text(json.dumps(card, indent=1) + "\n")
    worst = sorted((w["balanced_accuracy"], name) for name, w in card["words"].items())[:12]
    print(f"done in {time.perf_counter() - start:.0f} s; lowest: {worst}")


if __name__ == "__main__":
    main()
