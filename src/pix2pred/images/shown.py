"""Views as PNG files, kept for a while: the double check shows the same pictures again."""

from __future__ import annotations

import json
import threading
from collections import OrderedDict

from pix2pred.images.draw import draw_view
from pix2pred.images.png import fast_png
from pix2pred.structs.views import View

_KEPT = 64


class ShownPictures:
    """Draws and encodes views, losslessly; the latest ``_KEPT`` stay in memory. May be called from several threads."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, bytes] = OrderedDict()
        self._lock = threading.Lock()

    def __call__(self, view: View) -> bytes:
        """The PNG file of the view."""
        key = json.dumps(view.canonical(), sort_keys=True)
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
        shown = fast_png(draw_view(view))
        with self._lock:
            self._kept[key] = shown
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return shown
