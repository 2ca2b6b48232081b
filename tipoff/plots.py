"""Line plots and sketches: each is a figure of its own, unknown to the global state of pyplot."""

import functools
import io
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from tipoff.sketch import View

# face, edge and width of the line of each kind of shape
_STYLES = {
    "payload": ("#eceff3", "#8a94a3", 0.8),
    "rail": ("#9aa5b4", "none", 0.0),
    "mount": ("#3b4350", "none", 0.0),
    "pad": ("#e8a33d", "#8c6d46", 0.6),
    "axis": ("none", "#2b6cb0", 1.2),
    "thrust": ("none", "#d1495b", 2.2),
    "tilt": ("none", "#d1495b", 1.8),
    "shift": ("none", "#2e8b7a", 1.8),
}
_ANCHORS = {"start": "left", "middle": "center"}


class Plot(Figure):
    """A figure that a notebook shows without pyplot; ``savefig`` writes it to a file."""

    def _repr_png_(self) -> bytes:
        """The picture that a notebook shows."""
        stream = io.BytesIO()
        self.savefig(stream, format="png", dpi=110)
        return stream.getvalue()


def lines(
    across: tuple[str, np.ndarray],
    up: str,
    curves: Sequence[tuple[str, np.ndarray]],
    title: str = "",
    axes: Axes | None = None,
    **style: Any,
) -> Figure:
    """``curves`` by name over one variable ``across``; both axes have a title with a unit.

    ``axes`` belong to an existing figure; by default a new figure is made. ``style``: see
    ``Axes.plot``. Returns the figure. Raises TypeError for other ``axes``.
    """
    if axes is not None and not isinstance(axes, Axes):
        raise TypeError(f"axes: given a {type(axes).__name__}, expected axes of matplotlib")
    axes = axes or Plot(figsize=(7.0, 4.0), layout="constrained").add_subplot()
    words, values = across
    for name, curve in curves:
        axes.plot(values, curve, **{"label": name, **style})
    axes.set(xlabel=words, ylabel=up, title=title)
    axes.grid(alpha=0.3)
    if len(curves) > 1:
        axes.legend()
    found = axes.get_figure(root=True)
    assert found is not None  # true for axes of a figure
    return found


def sheets(size: tuple[float, float], title: str) -> tuple[Figure, list[Callable[..., View]]]:
    """A figure of two sketches beside each other, each of a ``size`` (px), and what makes their views."""
    found = Plot(figsize=(13.0, 3.8), layout="constrained")
    found.suptitle(title)
    makes: list[Callable[..., View]] = []
    for axes in np.ravel(found.subplots(1, 2)):
        axes.set(xlim=(0.0, size[0]), ylim=(size[1], 0.0), aspect="equal")
        axes.axis("off")
        makes.append(functools.partial(_Sheet, axes))
    return found, makes


class _Sheet(View):
    """A view that draws on ``axes`` in px."""

    def __init__(self, axes: Axes, at: tuple[float, float], scale: float, centre: Any):
        super().__init__(at, scale, centre)
        self.axes = axes

    def _patch(self, kind: str, make: Any, *given: Any) -> None:
        face, edge, width = _STYLES[kind]
        self.axes.add_patch(make(*given, facecolor=face, edgecolor=edge, linewidth=width))

    def box(self, kind: str, low: tuple[float, float], high: tuple[float, float]) -> None:
        """A rectangle between two corners (m)."""
        left, bottom = self.point(*low)
        right, top = self.point(*high)
        self._patch(kind, Rectangle, (left, top), right - left, bottom - top)

    def outline(self, kind: str, loops: Iterable[Iterable[tuple[float, float]]]) -> None:
        """The area of the first of some ``loops`` of corners (m) without the others."""
        self._patch(kind, PathPatch, Path.make_compound_path(*map(self._closed, loops)))

    def _closed(self, loop: Iterable[tuple[float, float]]) -> Path:
        places = [self.point(*each) for each in loop]
        return Path([*places, places[0]], closed=True)

    def corner(self, kind: str, sharp: Any, ends: Any, radius: float) -> None:
        """The area between a ``sharp`` corner and its fillet, as a triangle: it is small."""
        self._patch(kind, PathPatch, self._closed([ends[0], sharp, ends[1]]))

    def arrow(
        self, begin: tuple[float, float], end: tuple[float, float], kind: str = "axis"
    ) -> None:
        """An arrow between two places (px)."""
        _, edge, width = _STYLES[kind]
        style = {"arrowstyle": "-|>", "color": edge, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
        self.axes.annotate("", end, begin, arrowprops=style)

    def arc(self, begin: float, end: float, radius: float, kind: str) -> None:
        """An arc with an arrow about the centre; angles (rad), ``radius`` in px."""
        low, high = sorted((-math.degrees(begin), -math.degrees(end)))
        _, edge, width = _STYLES[kind]
        size = 2.0 * radius
        self.axes.add_patch(
            Arc(self.at, size, size, theta1=low, theta2=high, edgecolor=edge, linewidth=width)
        )
        before = end - math.copysign(0.05, end - begin)
        self.arrow(self._around(before, radius), self._around(end, radius), kind)

    def _around(self, angle: float, radius: float) -> tuple[float, float]:
        return self.at[0] + radius * math.cos(angle), self.at[1] - radius * math.sin(angle)

    def line(self, begin: tuple[float, float], end: tuple[float, float], kind: str) -> None:
        """A line between two places (px)."""
        _, edge, width = _STYLES[kind]
        self.axes.plot([begin[0], end[0]], [begin[1], end[1]], color=edge, linewidth=width)

    def text(self, place: tuple[float, float], words: str, anchor: str = "middle") -> None:
        """Words at a place (px)."""
        # a white edge, where words lie on a part
        edge = [withStroke(linewidth=2.5, foreground="white")]
        self.axes.text(*place, words, ha=_ANCHORS[anchor], fontsize=8.5, path_effects=edge)

    def dot(self, place: tuple[float, float], words: str) -> None:
        """A point at a place (px), with words below it."""
        self.axes.plot(*place, "o", color="#1f2630", markersize=4)
        self.text((place[0], place[1] + 16.0), words)
