"""Stress and motion of one condition: its peak and its files, and on the page the pictures."""

from pathlib import Path

from tipoff.studies.render.document import Caption, Image, Part
from tipoff.studies.view.stage import View
from tipoff.units import duration
from tipoff.workspace.words import counted


def draw(found: View, folder: Path) -> list[Part]:
    """What there is to see; the ``folder`` of the scene has the pictures."""
    name, peak = found.condition, found.peak
    place = ", ".join(f"{1e3 * value + 0.0:.4g}" for value in peak.place_m)
    words = (
        f"Condition {name}, elements of {1e3 * found.element_size_m:g} mm: "
        f"{counted(len(found.frames), 'frame')} for ParaView in `{found.collection}`. Peak von Mises "
        f"stress {1e-6 * peak.stress_pa:.4g} MPa at x, y, z = {place} mm, rail {peak.rail}, "
        f"{duration(peak.time_s, 4)} after ignition. {found.without_pictures}"
    )
    if not found.pictures:
        return [words.rstrip()]
    pictures = [
        Image(
            folder / found.pictures[kind],
            f"{kind} of {name}",
            folder / found.pictures[f"{kind}-dark"],
        )
        for kind in ("peak", "ejection")
    ]
    explained = Caption(
        "Pictures: seen from the platform, at the instant of the peak stress, and the ejection. The "
        f"rails are drawn with {found.factor:g} times their deformation, payload and pads to scale, so "
        "pads can appear inside a rail."
    )
    return [words.rstrip(), *pictures, explained]
