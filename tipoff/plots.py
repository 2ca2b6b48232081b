"""Line plots: each is a figure of its own, unknown to the global state of pyplot."""

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure


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
