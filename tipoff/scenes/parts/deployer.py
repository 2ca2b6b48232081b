"""``[deployer]``: a CubeSat of a standard form in its deployer, and what follows from the form.

The four rails of the CubeSat slide in four L rails of the deployer. Rails of a CubeSat are continuous: each
becomes a row of short pads, the first at its rear foot and the last at its front foot. A plate with
springs pushes the rear feet, and the door is at the front end of the rails. With the length L of a
CubeSat, in mm::

    pads   stations at most 54 apart, from -L/2 + 8.25 to L/2 - 8.25
    arm    L/2, from the mass centre to the plate
    stroke L - 10.5
"""

import math
from functools import partial
from typing import Any, Literal, NamedTuple, get_args

from tipoff.scenes import pads
from tipoff.scenes.parts.made import Made
from tipoff.scenes.parts.profiles import FRICTION
from tipoff.scenes.table import Table

Form = Literal["1u", "1.5u", "2u", "3u", "6u", "12u", "16u"]
_STANDARD = "CubeSat Design Specification, Rev. 14.1"
_PAD, _STEP, _GRID, _MOUNT = 16.0, 54.0, 8.0, 16.0  # mm: pad, stations, grid and length of mounts
_SHORT = 10.5  # mm from the stroke to the length
_AS_REFERENCE = "as on the scene reference"
CONTACT = {
    "law": "impact",
    "exponent": 1.5,
    "stiffness": "70000 N/mm**1.5",
    "damping": "60 N*s/mm",
    "damping_depth": "0.3 mm",
}
INTERFACE = {"interface_stiffness": "1.8e12 N/m**3"}
MATERIAL = {
    "density": "2700 kg/m**3",
    "youngs_modulus": "68.9 GPa",
    "poisson_ratio": 0.33,
    "yield_strength": "276 MPa",
}


class DeployerTable(Table):
    """``[deployer]``: a CubeSat of a standard form in four rails. Size and inertia of the payload, pads,
    rails, arm and stroke of the springs follow from it, where the scene does not state them."""

    #: Form of the CubeSat, of the CubeSat Design Specification; 16u is assumed.
    cubesat: Form


class CubeSat(NamedTuple):
    """Sizes (mm) along the rails and across, largest mass (kg), and source of both."""

    long: float
    across: tuple[float, float]  # along Y and Z
    most: float  # mass that the standard allows
    source: str
    # rear end of the rails, behind the centre, and mounts along them (mm): those of the scene
    # cubesat_3u, else by ``_rail``
    behind: float | None = None
    mounts: tuple[float, ...] = ()

    @property
    def stroke(self) -> float:
        """Stroke (mm) of the springs."""
        return self.long - _SHORT


CUBESATS = {
    "1u": CubeSat(113.5, (100.0, 100.0), 2.0, _STANDARD),
    "1.5u": CubeSat(170.2, (100.0, 100.0), 3.0, _STANDARD),
    "2u": CubeSat(227.0, (100.0, 100.0), 4.0, _STANDARD),
    "3u": CubeSat(340.5, (100.0, 100.0), 6.0, _STANDARD, 170.0, (0.0, 104.0, 216.0, 328.0)),
    "6u": CubeSat(366.0, (226.3, 100.0), 12.0, _STANDARD),
    "12u": CubeSat(366.0, (226.3, 226.3), 24.0, _STANDARD),
    "16u": CubeSat(454.0, (226.3, 226.3), 32.0, "assumed, since the standard ends at 12U"),
}
assert set(CUBESATS) == set(get_args(Form))


def expand(made: Made) -> None:
    """Payload, pads, rail, thrust, contact and friction of the deployer of a scene."""
    made.derived["pads"] = ""
    table = made.tables["deployer"]
    form = table.get("cubesat") if isinstance(table, dict) else None
    own = CUBESATS.get(form) if isinstance(form, str) else None
    if own is None:
        return  # the scene refuses it
    stated = f"{own.source}: {own.across[0]:g} x {own.across[1]:g} x {own.long:g} mm"
    _payload(made, own, stated)
    if "pads" not in made.raw:
        found: dict[str, Any] = {"pads": _pads(own)}
        pads.expand(found)
        source = f"{stated}; rails 8.5 mm wide; assumed: short pads in place of each rail"
        made.put("pads", found["pads"], source)
    _rail(made, own)
    thrust = made.tables.get("thrust")
    made.put_absent("thrust", {"arm": _mm(0.5 * own.long)}, "half of the length")
    springs = thrust.get("springs") if isinstance(thrust, dict) else None
    for place, spring in enumerate(springs if isinstance(springs, list) else ()):
        if isinstance(spring, dict) and not {"stroke", "file"} & set(spring):
            made.put(f"thrust.springs.{place}.stroke", _mm(own.stroke), "assumed")
    contact = made.tables.get("contact")
    if isinstance(contact, dict):
        if contact.get("law", "impact") == "impact":
            made.put_absent("contact", CONTACT, _AS_REFERENCE)
        made.put_absent("contact", INTERFACE, "assumed: ground metal")
    friction = made.tables.get("friction")
    if isinstance(friction, dict) and friction.get("law", "two-step") == "two-step":
        made.put_absent("friction", FRICTION, "assumed")


def _payload(made: Made, own: CubeSat, stated: str) -> None:
    payload = made.tables.get("payload")
    if not isinstance(payload, dict):
        return
    if "size" not in payload:
        size = [_mm(own.long), *map(_mm, own.across)]
        made.put("payload.size", size, f"{stated}, +- 0.1 mm across")
    sides = payload["size"] if isinstance(payload["size"], list) else []
    lengths = [length for length in map(made.length, sides) if length is not None]
    if len(lengths) == 3:
        made.put_inertia(payload, partial(_box, lengths), "assumed: a homogeneous box")


def _box(sides: list[float], mass: float) -> dict[str, str]:
    """Moments of inertia of a homogeneous box with these ``sides`` (m) and ``mass`` (kg)."""
    a, b, c = (side**2 for side in sides)
    moments = {"xx": b + c, "yy": a + c, "zz": a + b}
    return {axis: f"{mass * sum_ / 12.0:.6g} kg*m**2" for axis, sum_ in moments.items()}


def _pads(own: CubeSat) -> dict[str, Any]:
    """The rails of the CubeSat as a pattern of pads."""
    edge = 0.5 * own.long - 0.5 * _PAD - 0.25
    count = max(2, round(2.0 * edge / _STEP) + 1)
    places = [edge * (2.0 * place / (count - 1) - 1.0) for place in range(count)]
    return {
        "stations": [_mm(place) for place in places],
        "corner": [_mm(0.5 * side) for side in own.across],
        "length": _mm(_PAD),
        "width": "8 mm",
        "inset": "4.25 mm",
        "relief": "20 um",
    }


def _rail(made: Made, own: CubeSat) -> None:
    """Four L rails as long as the CubeSat, with mounts on a grid."""
    rail = made.tables.setdefault("rail", {})
    if not isinstance(rail, dict) or {"mesh", "geometry", "section"} & set(rail):
        return
    length = _GRID * math.ceil((own.long + 3.0) / _GRID)
    behind = math.ceil(0.5 * own.long) if own.behind is None else own.behind
    held = max(2, round(length / 110.0) + 1)
    begins = own.mounts or [
        _GRID * round((length - _MOUNT) * n / (held - 1) / _GRID) for n in range(held)
    ]
    values: dict[str, Any] = {
        "start": _mm(-behind),
        "end": _mm(length - behind),
        "leg": "16 mm",
        "thickness": "4 mm",
        "mount_width": "4 mm",
        "mounts": [{"start": _mm(x), "end": _mm(x + _MOUNT)} for x in begins],
    }
    source = "assumed: as long as the CubeSat, since no drawing of a deployer was at hand"
    for name, value in values.items():
        if name not in rail:
            made.put(f"rail.{name}", value, source)
    if "material" not in rail:
        made.put("rail.material", dict(MATERIAL), "handbook, 6061-T6")


def _mm(length: float) -> str:
    return f"{round(length, 6):g} mm"
