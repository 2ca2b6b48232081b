"""Rail compliance on the page: how far a wall gives way under a pad, and what pressing one wall
does to the other."""

from typing import TYPE_CHECKING

import numpy as np

from tipoff.studies.render.chart import AMBER, GREY, NAVY, TEAL, VERMILION, Chart, Line, Panel
from tipoff.studies.render.markup import Html, number, section
from tipoff.studies.render.markup import table as markup_table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

WORDS = (
    "Static displacement of a wall of the rail, averaged over the face of a rear pad, per force "
    "spread evenly over a face, "
    "from the matrices of the reference at {size:g} mm. Grey: mounts. Dashed: one wall under a "
    "force on the other; below zero "
    "the other wall comes towards the payload."
)
_DIRECT, _CROSS = (NAVY, VERMILION, TEAL), (AMBER, GREY)
# The legs of a symmetric section give way alike: the first line is broad and pale, so that the next
# shows on it.
_LOOKS = ((5.0, "-", 0.35), (1.5, "-", 1.0), (1.5, ":", 1.0))  # width, dash, opacity


def draw(page: "Page") -> Html:
    """The section; nothing for a scene without contact."""
    found = page.documents.get("compliance") or {}
    if not found.get("under_a_pad"):
        return Html("")
    return section(
        "compliance",
        "Rail compliance",
        page.figure(
            picture(found["under_a_pad"]), WORDS.format(size=1e3 * found["element_size_m"])
        ),
        table(found["under_a_pad"]),
    )


def picture(found: dict) -> Chart:
    """Compliance over the place of the pad, mounts shaded; ``found`` is that part of mesh.json."""
    place = 1e3 * np.array(found["place_m"])
    lines = [
        Line(place, 1e9 * np.array(values), f"{name} wall, pressed itself", colour, *look)
        for (name, values), colour, look in zip(found["direct_m_per_n"].items(), _DIRECT, _LOOKS)
    ]
    lines += [
        Line(
            place,
            1e9 * np.array(values),
            f"{' wall, pressing '.join(name.split())}",
            colour,
            2.0,
            "--",
        )
        for (name, values), colour in zip(found["cross_m_per_n"].items(), _CROSS)
    ]
    mounts = tuple((1e3 * low, 1e3 * high) for low, high in found["mounts_m"])
    return Chart(
        "compliance",
        [Panel("", "middle of the pad along X (mm)", "compliance (nm/N)", lines, spans=mounts)],
        height=320,
    )


def table(found: dict) -> Html:
    """Smallest, median and largest compliance, the place of the largest, and the ratio of cross and
    direct one."""
    place = 1e3 * np.array(found["place_m"])
    rows = [
        (f"{name} wall", *_figures(np.array(values), place), "")
        for name, values in found["direct_m_per_n"].items()
    ]
    for name, values in found["cross_m_per_n"].items():
        first, second = (np.array(found["direct_m_per_n"][each]) for each in name.split())
        ratio = np.array(values) / np.sqrt(first * second)
        rows.append(
            (
                f"{' and '.join(name.split())}, cross",
                *_figures(np.array(values), place),
                f"{ratio.min():.2f} to {ratio.max():.2f}",
            )
        )
    return markup_table(
        (
            "",
            "smallest (nm/N)",
            "median (nm/N)",
            "largest (nm/N)",
            "largest at X (mm)",
            "of the direct one",
        ),
        rows,
    )


def _figures(values: np.ndarray, place: np.ndarray) -> tuple:
    """By magnitude."""
    order = np.argsort(np.abs(values))
    return (
        *(number(1e9 * values[order[at]]) for at in (0, len(order) // 2, -1)),
        f"{place[order[-1]]:.4g}",
    )
