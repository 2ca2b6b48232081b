"""How figures show the cases that lie outside what a calibration was made for: markers without a filling, which grey paper tells
too."""

import math
from dataclasses import replace
from typing import Sequence

import numpy as np

from studies.report.chart import GREY, Line

NAME = "hollow: outside the calibration"
WORDS = " Hollow: outside what the calibration was made for."
_SEEN = 0.75  # least opacity of a marker that is only an edge


def points(line: Line, outside: Sequence[bool]) -> list[Line]:
    """The points of ``line``, those ``outside`` (n,) hollow; the line itself where none is."""
    flags, x, y = np.asarray(outside, dtype=bool), np.asarray(line.x, dtype=float), np.asarray(line.y, dtype=float)
    if not flags.any():
        return [line]
    # A line without points would have no entry of the legend; one that is no number has it, and is drawn nowhere.
    inside = replace(line, x=[math.nan], y=[math.nan]) if flags.all() else replace(line, x=x[~flags], y=y[~flags])
    share = flags.mean()  # both are thinned alike on the page, which would show another share else
    some = [round(line.kept * part) or 1 for part in (1.0 - share, share)]
    return [replace(inside, kept=some[0]), replace(_hollow(line, x[flags], y[flags]), kept=some[1])]


def over(line: Line, outside: Sequence[bool]) -> list[Line]:
    """A ``line`` whose markers are hollow where it is ``outside`` (n,); as it is where none is."""
    flags = np.asarray(outside, dtype=bool)
    if not flags.any():
        return [line]
    return [line, _hollow(line, np.asarray(line.x, dtype=float)[flags], np.asarray(line.y, dtype=float)[flags])]


def key(outside: Sequence[bool]) -> list[Line]:
    """One entry of the legend for hollow markers of every colour and form, where any case is ``outside`` (n,)."""
    return [Line([math.nan], [math.nan], NAME, GREY, dash="", marker="o", size=6.0, hollow=True)] if np.any(outside) else []


def _hollow(line: Line, x: np.ndarray, y: np.ndarray) -> Line:
    return replace(line, x=x, y=y, name=NAME, dash="", hollow=True, legend=False, opacity=max(line.opacity, _SEEN))
