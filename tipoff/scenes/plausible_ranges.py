"""Plausible ranges of single values (a value outside is probably wrong, for example in its unit),
and of the angle by which a payload can turn between the walls.

Sources: Marks' Standard Handbook for Mechanical Engineers, section 3.2 (coefficients of friction);
Newmark and Hall, Earthquake Spectra and Design, EERI 1982 (damping of structures); CRC Handbook of
Chemistry and Physics (density of osmium, modulus of diamond); Ashby, Materials Selection in
Mechanical Design (moduli of polymers and elastomers); Hunt and Crossley, J. Appl. Mech. 42 (1975)
440 (restitution).
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from tipoff.scenes import overrides
from tipoff.scenes.rounding import at_most, below


class Range(NamedTuple):
    """Range of plausible values."""

    least: float
    most: float
    unit: str  # SI, of both


# Dry aluminium on aluminium slides at 1.4, the largest coefficient of the handbook's table.
_FRICTION = Range(0.0, 1.5, "")
RANGES = {
    "friction.static": _FRICTION,
    "friction.dynamic": _FRICTION,
    # A body that meets its wall at v rebounds with the share 1 - 2 a v / 3. Metals have a below 0.5
    # s/m; this value takes two thirds of the speed at 10 mm/s.
    "contact.dissipation": Range(0.0, 100.0, "s/m"),
    # bolted steel just below yield; half of that at working stress
    "rail.damping.ratios": Range(0.0, 0.15, ""),
    # balsa wood, and osmium
    "rail.material.density": Range(100.0, 22_600.0, "kg/m3"),
    # the softest polymers that are no elastomers, and diamond
    "rail.material.youngs_modulus": Range(1e8, 1.22e12, "Pa"),
    # the softest elastomers, and diamond
    "contact.pad_layer.youngs_modulus": Range(1e5, 1.22e12, "Pa"),
}
# Of the shortest side of a pad. The loosest fit of ISO 286, H11/c11, has at most 0.82 mm at 200 mm,
# a twentieth of a pad of the catalogue.
CLEARANCE = 0.1
TURN = math.radians(0.5)  # five times the tilt of the thrust in the catalogue


def warnings(scene) -> list[str]:
    """A message for each value of a scene outside its range, and for walls that let the payload
    turn."""
    found = [
        f"{key}: {value:.4g}{_unit(own)}, plausible {own.least:g} to {own.most:g}{_unit(own)}"
        for key, own in RANGES.items()
        for value in _values(scene, key)
        if below(value, own.least) or below(own.most, value)
    ]
    return found + (_of_clearance(scene) + _of_turning(scene) if scene.contact is not None else [])


def _unit(own: Range) -> str:
    return f" {own.unit}" if own.unit else ""


def _values(scene, key: str) -> Iterator[float]:
    """The value or values of a dotted key; none if a table is absent or has another law."""
    found = overrides.held(scene, key)
    if found is not None:
        yield from found if isinstance(found, tuple) else (found,)


def _of_clearance(scene) -> list[str]:
    """Clearances that are large relative to a pad; the larger one of both axes is taken. The play of lugs
    follows from two diameters, and its own rule refuses a large one (``scenes.parts.lugs``)."""
    if scene.lugs is not None:
        return []
    widest = max(scene.contact.gaps()[1:])
    most = CLEARANCE * min(min(pad.length, pad.width) for pad in scene.pads)
    if at_most(widest, most):
        return []
    return [
        f"contact.clearance, pads: {1e3 * widest:.4g} mm, plausible up to {1e3 * most:.4g} mm, a "
        f"tenth of a pad's shortest side"
    ]


def _of_turning(scene) -> list[str]:
    """Pads that are too close together along X to hold a payload straight.

    A body of length ``reach`` between two walls with the clearance c on both sides turns by 2 c /
    reach. An axis without pads on both sides is not held by design.
    """
    found = []
    for axis, clearance in zip("yz", scene.contact.gaps()[1:]):
        pads = [pad for pad in scene.pads if {f"+{axis}", f"-{axis}"} & set(pad.normals)]
        if {sign for pad in pads for sign in "+-" if f"{sign}{axis}" in pad.normals} != {"+", "-"}:
            continue
        ends = [pad.position[0] + side * pad.length for pad in pads for side in (-0.5, 0.5)]
        turn = 2.0 * clearance / (max(ends) - min(ends))
        if below(TURN, turn):
            found.append(
                f"pads, contact.clearance: along {axis} the walls allow the payload to turn "
                f"by {math.degrees(turn):.3g} deg, plausible up to {math.degrees(TURN):g} deg; "
                "longer pads or more stations reduce this angle"
            )
    return found[:1]
