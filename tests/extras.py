"""What a test needs beyond the core, said in one line: ``pytestmark = need("unified_planning", extra="planners")``."""

from __future__ import annotations

import pytest


def need(*modules: str, extra: str) -> pytest.MarkDecorator:
    """Mark tests that need importable ``modules``, which ``pip install 'pix2pred[extra]'`` brings.

    Without them the tests are skipped, naming the extra; with PIX2PRED_NO_SKIPS=1 (``make test-all``) they fail.
    """
    return pytest.mark.extra(*modules, extra=extra)
