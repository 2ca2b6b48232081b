"""The view of one ejection in the browser: a widget that draws what it is sent."""

from pathlib import Path

import anywidget
import traitlets

from tipoff import RailCompliance, Scene

_HERE = Path(__file__).parent
_PARTS = ("colours.js", "space.js", "launcher.js", "charts.js", "page.js", "view.js")


class EjectionView(anywidget.AnyWidget):
    """Draws ``shown`` and plays it: ``message.made``, the ``number`` of the values of the sliders, and
    ``is_final`` for a run that was made when they rested. ``rested`` is the number of the values at
    which they rest; ``error`` belongs to the values of its own ``number``. ``latest`` are the
    scene that is shown and the compliance of its rails; they stay here."""

    # A widget is one module to the browser, so the files are joined.
    _esm = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in _PARTS)
    _css = (_HERE / "view.css").read_text(encoding="utf-8")
    shown = traitlets.Dict().tag(sync=True)
    error = traitlets.Dict().tag(sync=True)
    rested = traitlets.Int(0).tag(sync=True)
    latest: tuple[Scene, RailCompliance | None]
