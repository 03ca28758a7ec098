"""``offline``: the reader of a bundled domain, as a model that ``--vlm`` can name."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.vlm.model_spec import Kind, ModelNameError, ModelSpec, Setup
from pix2pred.vlm.request import VLM


@dataclass(frozen=True, slots=True)
class OfflineSpec(ModelSpec):
    """The small classifiers that come with a domain; which domain, the run's setup says."""

    @property
    def writes(self) -> bool:
        return False

    def connect(self, setup: Setup) -> VLM:
        """The reader. Raises ``ModelNameError`` for a domain that has none."""
        if setup.reader is None:
            raise ModelNameError(
                "the offline reader knows only the bundled domains; name a model with --vlm for your data"
            )
        from pix2pred.vlm.offline.model import ReaderModel
        from pix2pred.vlm.offline.reader import OfflineReader

        return OfflineReader(setup.domain, ReaderModel.load(setup.reader))


OFFLINE = Kind("offline", lambda rest: OfflineSpec())
