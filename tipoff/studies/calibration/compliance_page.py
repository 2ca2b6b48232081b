"""Rail compliance on the page: displacement of each wall under a force on it and under a force on
the other wall."""

from dataclasses import replace

import numpy as np

from tipoff.studies.calibration.compliance import Compliance, UnderPad
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Missing, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Table

_CAPTION = (
    "Static displacement of a wall, averaged over the face of a rear pad, per force spread evenly "
    "over a face; reference mesh of {size:g} mm. Grey: mounts. Dashed: displacement of one wall "
    "under a force on the other; negative values are towards the payload."
)
_DIRECT, _CROSS = (NAVY, VERMILION, TEAL), (AMBER, GREY)
# The walls of a symmetric section have equal compliance, so the first line is broad and pale and
# the next one is visible on it.
_LOOKS = ((5.0, "-", 0.35), (1.5, "-", 1.0), (1.5, ":", 1.0))  # width, dash, opacity


def draw(found: Compliance) -> list[Part]:
    """The curves and their extremes."""
    if (under := found.under_a_pad) is None or found.element_size_m is None:
        return [Missing("No contact: no compliance.")]
    caption = _CAPTION.format(size=1e3 * found.element_size_m)
    notes = (f"Elements: {found.elements['words']}.",) if found.elements else ()
    return [Figure(lambda: picture(under), caption), replace(table(under), notes=notes)]


def picture(found: UnderPad) -> Chart:
    """Compliance over the place of the pad, mounts shaded."""
    place = 1e3 * np.array(found.place_m)
    direct, cross = found.direct_m_per_n.items(), found.cross_m_per_n.items()
    lines = [
        Line(place, 1e9 * np.array(values), f"{name} wall, force on itself", colour, *look)
        for (name, values), colour, look in zip(direct, _DIRECT, _LOOKS)
    ]
    for (name, values), colour in zip(cross, _CROSS):
        words = " wall, force on ".join(name.split())
        lines.append(Line(place, 1e9 * np.array(values), words, colour, 2.0, "--"))
    mounts = tuple((1e3 * low, 1e3 * high) for low, high in found.mounts_m)
    axes = "middle of the pad along X (mm)", "compliance (nm/N)"
    return Chart("compliance", [Panel("", *axes, lines, spans=mounts)], height=320)


def table(found: UnderPad) -> Table:
    """Smallest, median and largest compliance by magnitude, the place of the largest, and the ratio
    of a cross compliance to the geometric mean of the direct ones."""
    direct = {name: np.array(values) for name, values in found.direct_m_per_n.items()}
    place = np.array(found.place_m)
    rows = [(f"{name} wall", *_figures(values, place), "") for name, values in direct.items()]
    for name, values in found.cross_m_per_n.items():
        first, second = name.split()
        ratio = np.array(values) / np.sqrt(direct[first] * direct[second])
        rows.append(
            (
                f"{first} and {second}, cross",
                *_figures(np.array(values), place),
                f"{ratio.min():.2f} to {ratio.max():.2f}",
            )
        )
    return Table(
        (
            "",
            *(Column(title, "nm/N", scale=1e9) for title in ("smallest", "median", "largest")),
            Column("largest at X", "mm", ".4g", 1e3),
            "ratio to the direct one",
        ),
        rows,
    )


def _figures(values: np.ndarray, place: np.ndarray) -> tuple[float, float, float, float]:
    """Smallest, median and largest of ``values`` by magnitude, and the place of the largest."""
    order = np.argsort(np.abs(values))
    return (
        values[order[0]],
        values[order[len(order) // 2]],
        values[order[-1]],
        place[order[-1]],
    )
