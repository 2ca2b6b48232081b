"""The inputs that the paper does not print, as points of the unit cube: bounds with their reasons,
and the overrides of a scene.

The inertia belongs to a mass distribution, so every point of the cube is a possible body. With the second
moments P_i = m g_i^2 about the mass centre (radii g along the axes) and P_ij = r_ij sqrt(P_i P_j):

    I_xx = P_y + P_z,  I_yy = P_x + P_z,  I_zz = P_x + P_y,  I_ij = -P_ij

P is positive definite if the correlations r are small. A uniform cuboid of edge L has g = L / sqrt(12).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tipoff.scenes.scene import Scene


class Unknown(NamedTuple):
    """An input of the search."""

    name: str
    low: float  # bound, SI
    high: float  # bound, SI
    unit: str  # for printing
    reason: str  # for the bounds
    factor: float = 1.0  # printed number over the SI value
    logarithmic: bool = False  # scale of the search

    def value(self, share: float) -> float:
        """Value (SI) at ``share`` (0 to 1) of the way from the lower to the upper bound."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share

    def share(self, value: float) -> float:
        """Inverse of ``value``."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


_BODY = "cuboid edges of 0.1 to 0.6 m, the scale of the group's drawings"
UNKNOWNS = (
    Unknown("mass", 8.0, high=12.0, unit="kg", reason="9.9 kg in the group's companion paper"),
    Unknown("radius_x", 0.06, high=0.15, logarithmic=True, unit="mm", factor=1e3, reason=_BODY),
    Unknown("radius_y", 0.03, high=0.09, logarithmic=True, unit="mm", factor=1e3, reason=_BODY),
    Unknown("radius_z", 0.03, high=0.09, logarithmic=True, unit="mm", factor=1e3, reason=_BODY),
    Unknown(
        "correlation_xy", -0.15, high=0.15, unit="1", reason="equipment off the axes of symmetry"
    ),
    Unknown(
        "correlation_xz", -0.15, high=0.15, unit="1", reason="equipment off the axes of symmetry"
    ),
    Unknown(
        "correlation_yz", -0.15, high=0.15, unit="1", reason="equipment off the axes of symmetry"
    ),
    Unknown(
        "rear",
        0.03,
        high=0.15,
        unit="mm",
        factor=1e3,
        reason="rear pads behind the mass centre, within the body",
    ),
    Unknown(
        "front",
        0.03,
        high=0.15,
        unit="mm",
        factor=1e3,
        reason="front pads ahead of the mass centre, within the body",
    ),
    Unknown(
        "half_width",
        0.06,
        high=0.14,
        unit="mm",
        factor=1e3,
        reason="pads at the corners of the body",
    ),
    Unknown(
        "half_height",
        0.06,
        high=0.14,
        unit="mm",
        factor=1e3,
        reason="pads at the corners of the body",
    ),
    Unknown(
        "guided",
        0.02,
        high=0.40,
        logarithmic=True,
        unit="mm",
        factor=1e3,
        reason="length of rail ahead of the front pads at ignition",
    ),
    Unknown(
        "clearance",
        0.03e-3,
        high=0.5e-3,
        logarithmic=True,
        unit="mm",
        factor=1e3,
        reason="sliding fit to loose fit",
    ),
    Unknown(
        "arm", 0.05, high=0.20, unit="mm", factor=1e3, reason="thruster at the rear of the body"
    ),
    Unknown(
        "impulse",
        30.0,
        high=120.0,
        logarithmic=True,
        unit="N s",
        reason="exit speed of 3 to 12 m/s",
    ),
    Unknown(
        "width",
        1e-3,
        high=10e-3,
        logarithmic=True,
        unit="ms",
        factor=1e3,
        reason="solid thruster with 5 to 50 ms burn time",
    ),
    Unknown(
        "friction",
        0.02,
        high=0.4,
        logarithmic=True,
        unit="1",
        reason="aluminium, bare or lubricated; 0.2 in the companion paper",
    ),
    Unknown(
        "exponent",
        1.0,
        high=2.2,
        unit="1",
        reason="from flat contact to above Hertz contact; not printed in the paper",
    ),
    Unknown(
        "offset_y",
        -0.9,
        high=0.9,
        unit="of the clearance",
        reason="position of the body between the rails at ignition",
    ),
    Unknown(
        "offset_z",
        -0.9,
        high=0.9,
        unit="of the clearance",
        reason="position of the body between the rails at ignition",
    ),
)
NAMES = tuple(item.name for item in UNKNOWNS)
STIFFNESS, DAMPING, DEPTH = 70000.0, 60e3, 0.3e-3  # N/mm^e, N s/m, m: the paper's Table 2 baseline
_CENTRE = 3.0  # widths before the peak of the thrust
_MOUNTS = ((0.05, 0.15), (0.45, 0.55), (0.85, 0.95))  # shares of the rail; the rail is rigid here


def values(shares: np.ndarray) -> dict[str, float]:
    """Values (SI) by name at a point (p,) of the unit cube."""
    return {item.name: item.value(float(share)) for item, share in zip(UNKNOWNS, shares)}


def shares(found: dict[str, float]) -> np.ndarray:
    """Inverse of ``values``."""
    return np.array([item.share(found[item.name]) for item in UNKNOWNS])


def inertia(found: dict[str, float]) -> dict[str, float]:
    """Entries of the inertia tensor (kg m2) about the mass centre."""
    radius = {axis: found[f"radius_{axis}"] for axis in "xyz"}
    moment = {axis: found["mass"] * radius[axis] ** 2 for axis in "xyz"}
    product = {
        a + b: -found["mass"] * found[f"correlation_{a}{b}"] * radius[a] * radius[b]
        for a, b in ("xy", "xz", "yz")
    }
    return {
        "xx": moment["y"] + moment["z"],
        "yy": moment["x"] + moment["z"],
        "zz": moment["x"] + moment["y"],
        **product,
    }


def overrides(base: Scene, found: dict[str, float]) -> dict[str, Any]:
    """Dotted overrides (SI) that turn ``base``, with eight pads at the corners, into the scene of
    these inputs."""
    clearance, width, exponent = found["clearance"], found["width"], found["exponent"]
    changed = {
        "payload.mass": found["mass"],
        **{f"payload.inertia.{entry}": value for entry, value in inertia(found).items()},
    }
    for number, pad in enumerate(base.pads):
        x, y, z = pad.position
        changed[f"pads.{number}.position.0"] = found["front"] if x > 0.0 else -found["rear"]
        changed[f"pads.{number}.position.1"] = math.copysign(found["half_width"], y)
        changed[f"pads.{number}.position.2"] = math.copysign(found["half_height"], z)
    start = -found["rear"] - 0.5 * base.pads[0].length
    end = found["front"] + 0.5 * base.pads[0].length + found["guided"]
    return changed | {
        "rail.start": start,
        "rail.end": end,
        "contact.clearance": clearance,
        "contact.exponent": exponent,
        "contact.stiffness": stiffness(STIFFNESS, exponent),
        "contact.damping": DAMPING,
        "contact.damping_depth": DEPTH,
        "friction.static": found["friction"],
        "friction.dynamic": found["friction"],
        "thrust.peak": found["impulse"] / (width * math.sqrt(2.0 * math.pi)),
        "thrust.width": width,
        "thrust.centre": _CENTRE * width,
        "thrust.arm": found["arm"],
        "initial.position.y": found["offset_y"] * clearance,
        "initial.position.z": found["offset_z"] * clearance,
        "rail.mounts": [
            {"start": first * (end - start), "end": last * (end - start)} for first, last in _MOUNTS
        ],
        "duration": duration(found),
    }


def stiffness(printed: float, exponent: float) -> float:
    """The paper's k (N/mm^e) in N/m^e."""
    return printed * 1e3**exponent


def duration(found: dict[str, float]) -> float:
    """Time (s) in which the body leaves the rail and settles: the longer of the burn time and the
    time for the distance at half the final speed."""
    distance = found["rear"] + found["front"] + found["guided"] + 0.016
    return (
        max(
            7.0 * found["width"],
            _CENTRE * found["width"] + 2.0 * distance * found["mass"] / found["impulse"],
        )
        + 6e-3
    )
