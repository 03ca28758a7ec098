"""Running classifiers that a model wrote: allow-listed syntax, in a process that can do nothing but compute."""

from pix2pred.approaches.sandbox.process import CodeError, SandboxError, SandboxLimits, run_classifier

__all__ = ["CodeError", "SandboxError", "SandboxLimits", "run_classifier"]
