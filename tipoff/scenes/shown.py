"""A scene for people: one line, a summary, a card, a plot."""

from typing import TYPE_CHECKING, Any

import numpy as np

from tipoff.cards import Carded
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes import launch
from tipoff.scenes.effects.measured_table import MeasuredTable
from tipoff.scenes.effects.spring import PushedTable
from tipoff.units import duration

if TYPE_CHECKING:
    from tipoff.plots import Figure
    from tipoff.scenes.scene import Scene

_MOST_NAMES = 12  # of conditions in one line
_PLOTTED = 1001  # points of a curve


class Shown(Carded):
    """Base of ``scenes.scene.Scene``, which it shows."""

    def __repr__(self: Any) -> str:
        return (
            f"Scene({self.name!r}, {self.payload.mass:g} kg, {len(self.pads)} pads, "
            f"{len(self.conditions)} conditions, hash {self.hash[:8]})"
        )

    __str__ = __repr__

    def _facts(self: Any) -> dict[str, str]:
        return facts(self)

    def plot(self: Any, quantity: str = "launcher", axes: Any = None) -> "Figure":
        """Draw the launcher to scale, from the side and from its open end: payload, pads, rails, mounts, mass
        centre and line of the thrust. Or draw the thrust (N) over the time after ignition (ms); that of
        springs for a payload without friction on its rails.

        Args:
            quantity: ``launcher`` or ``thrust``.
            axes: matplotlib axes for the thrust; a new figure by default.

        Returns:
            Figure: the figure. pyplot does not know a new one; a notebook shows it.

        Raises:
            ValueError: another quantity.

        Example:
            >>> scene = tipoff.load("tiny")
            >>> len(scene.plot().axes)
            2
            >>> scene.plot("thrust").axes[0].get_ylabel()
            'thrust (N)'
        """
        from tipoff import plots  # slow to load
        from tipoff.scenes import drawing

        if quantity == "launcher" and axes is None:
            return drawing.figure(self)
        if quantity != "thrust":
            raise ValueError(f"quantity: given {quantity!r}, expected launcher or thrust")

        time = np.linspace(0.0, self.expected_end, _PLOTTED)
        force = thrust_law.sample(ends.over_time(launch.of_scene(self)), time)
        across = ("time after ignition (ms)", 1e3 * time)
        return plots.lines(across, "thrust (N)", [("thrust", force)], self.name, axes)


def facts(scene: "Scene") -> dict[str, str]:
    """Text with units by title, including implausible values."""
    rail, contact = scene.rail, scene.contact
    found = {"name": scene.name}
    if scene.description:
        found["about"] = scene.description
    size = "" if scene.payload.size is None else f", {_mm(*scene.payload.size)}"
    found |= {
        "payload": f"{scene.payload.mass:g} kg{size}",
        "pads": f"{len(scene.pads)}",
        "rail": f"{_mm(rail.end - rail.start)} long, ends at X = {_mm(rail.end)}",
        "thrust": _thrust(scene),
        "contact": "absent" if contact is None else f"clearance {_gaps(contact)}",
        "friction": "absent" if scene.friction is None else f"dynamic {scene.friction.dynamic:g}",
        "platform": "rails are fixed"
        if scene.platform is None
        else f"free, {scene.platform.mass:g} kg",
        "duration": _duration(scene),
        "conditions": _names(list(scene.conditions)),
    }
    if absent := scene.absent_effects():
        found["absent"] = ", ".join(absent)
    if scene.warnings:
        found["implausible"] = "; ".join(scene.warnings)
    return found


def _thrust(scene: "Scene") -> str:
    if isinstance(scene.thrust, PushedTable):
        return scene.thrust.words()
    record = scene.thrust.record()
    peak, whole = (law(record, scene.time_limit) for law in (thrust_law.peak, thrust_law.impulse))
    said = f"{scene.thrust.kind}, peak {peak:.4g} N, impulse {whole:.4g} N*s within the duration"
    notes = scene.thrust.notes() if isinstance(scene.thrust, MeasuredTable) else []
    return "; ".join([said, *notes])


def _duration(scene: "Scene") -> str:
    if scene.duration is not None:
        return duration(scene.duration)
    return f"until settled or jammed, at most {scene.time_limit:.4g} s"


def _gaps(contact) -> str:
    _, y, z = contact.gaps()
    return _mm(y) if y == z else f"{_mm(y)} along y, {_mm(z)} along z"


def _names(names: list[str]) -> str:
    if len(names) <= _MOST_NAMES:
        return ", ".join(names) or "none"
    return f"{', '.join(names[:_MOST_NAMES])} and {len(names) - _MOST_NAMES} more"


def _mm(*lengths: float) -> str:
    """Text of lengths (m) in mm."""
    return " x ".join(f"{1e3 * length:g}" for length in lengths) + " mm"
