"""The files of a run folder: every name once.

config.yaml                  the resolved settings, the data and the model that labelled it
answers/, blobs/             the answer store (unless another one was named)
proposals.json               accepted and rejected atoms per demonstration
labels/as_said.json          the truth table as the model gave it
labels/evidence.json         its explanations, and the pictures and boxes it saw
labels/gaps.json             atoms that no answer gave a value, and why
corrections.jsonl            what a person set right, a row each; only ever appended to
labels/traces.json           the corrected truth table, readable by ``pix2pred select``
labels/doubts.json           labels that are probably wrong, the most useful to check first
selection.json               the climb, step by step
history/<n>.json             the same as it was with the first n corrections
model/                       world_model.json, domain.pddl, samplers.npz (for skills with continuous parameters)
metrics.json, timings.json   counts; seconds and queries
solve/<name>/<task>.json     one file per episode, and summary.json
plans/<task>/                a plan for one photographed scene (``runs.plan_folder``)
report.html                  all of it to look at, made anew after every command
"""

from __future__ import annotations

from pix2pred.predicates import CORRECTIONS, EVIDENCE

__all__ = ["CORRECTIONS", "EVIDENCE"]

CONFIG = "config.yaml"
LOCK = ".lock"
PROPOSALS = "proposals.json"
AS_SAID = "labels/as_said.json"
"""The truth table as the model gave it; ``TRACES`` is what is left of it after corrections."""
GAPS = "labels/gaps.json"
TRACES = "labels/traces.json"
ADVICE = "labels/doubts.json"
SELECTION = "selection.json"
HISTORY = "history"
"""Selections by the number of corrections they were made with."""
MODEL = "model/world_model.json"
PDDL = "model/domain.pddl"
SAMPLERS = "model/samplers.npz"
METRICS = "metrics.json"
TIMINGS = "timings.json"
SOLVED = "solve"
SUMMARY = "summary.json"
PLANS = "plans"
REPORT = "report.html"
