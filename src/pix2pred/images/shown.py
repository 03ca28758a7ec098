"""Views as PNG files, kept for a while: the double check shows the same pictures again."""

from __future__ import annotations

import io
import json
import threading
from collections import OrderedDict

from PIL import Image as PILImage

from pix2pred.images.draw import draw_view
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
        buffer = io.BytesIO()
        # little compression: a few more bytes on the way, a tenth of the time
        PILImage.fromarray(draw_view(view)).save(buffer, "PNG", compress_level=1)
        with self._lock:
            self._kept[key] = buffer.getvalue()
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return buffer.getvalue()
