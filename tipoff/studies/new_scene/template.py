"""A commented scene file of a launcher from a few numbers.

The payload is a box of uniform density in four L rails, pushed by one pulse of thrust that is tilted
by 0.1 deg. What is not given has the proportions of the scene ``reference``; its provenance is
"assumed".
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.outcome import SETTLE_DELAY, SETTLE_WINDOW
from tipoff.scenes.effects import thrust_law
from tipoff.scenes.effects.thrust import GaussianTable
from tipoff.scenes.faults import Fault, SceneError

_WIDTH = 0.2  # m, of the payload of the scene ``reference``, whose sections are scaled
_MARGIN = 1.25  # of the duration: friction delays the exit


class Numbers(NamedTuple):
    """Mass (kg) and outer sizes (m) of the payload, travel along the rail (m), clearance (m), peak
    of the thrust (N), time in which it rises and falls (s)."""

    mass: float = 9.9
    size: tuple[float, float, float] = (0.35, 0.20, 0.20)
    rail_length: float = 0.22
    clearance: float = 0.25e-3
    thrust: float = 6000.0
    burn_time: float = 0.024

    def faults(self) -> list[Fault]:
        """Numbers that make no launcher."""
        listed = {
            "--mass": (self.mass,),
            "--size": self.size,
            "--rail-length": (self.rail_length,),
            "--clearance": (self.clearance,),
            "--thrust": (self.thrust,),
            "--burn-time": (self.burn_time,),
        }
        found = [
            Fault(option, "value", ", ".join(f"{value:g}" for value in values), "above zero")
            for option, values in listed.items()
            if min(values) <= 0.0
        ]
        if self.clearance > 0.05 * min(self.size[1:]) > 0.0:
            given = f"{1e3 * self.clearance:g} mm"
            most = f"at most {50.0 * min(self.size[1:]):g} mm, a twentieth of the payload's width"
            found.append(Fault("--clearance", "value", given, most))
        return found


def duration(numbers: Numbers) -> float:
    """Duration (s) in which the rates settle: the exit of a payload that the thrust alone moves, and
    the settled window after it (``mechanics.outcome``), with a margin."""
    law = GaussianTable.model_validate(
        {
            "kind": "gaussian",
            "peak": numbers.thrust,
            "width": numbers.burn_time / 6.0,
            "centre": numbers.burn_time / 2.0,
        },
        context={"bare_numbers_are_si": True},
    ).record()
    time = np.linspace(0.0, 2.0 * numbers.burn_time, 4001)
    speed = _integral(thrust_law.sample(law, time) / numbers.mass, time)
    place = _integral(speed, time)
    exits = float(np.interp(numbers.rail_length, place, time))
    if place[-1] < numbers.rail_length:
        exits = float(time[-1] + (numbers.rail_length - place[-1]) / speed[-1])
    burnt = thrust_law.burnout(law, 1e-3, 2.0 * numbers.burn_time)
    return _MARGIN * (max(exits + SETTLE_DELAY, burnt) + SETTLE_WINDOW)


def _integral(values: np.ndarray, time: np.ndarray) -> np.ndarray:
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(time)
    return np.concatenate([[0.0], np.cumsum(steps)])


def text(name: str, numbers: Numbers) -> str:
    """The scene as TOML. Raises SceneError, every fault listed."""
    if faults := numbers.faults():
        raise SceneError(faults)
    a, b, c = numbers.size
    scale, rail = min(b, c) / _WIDTH, numbers.rail_length
    pad, station = 16.0 * scale, 1e3 * a * 0.08 / 0.35
    start = -station - 0.5 * pad
    mounts = [
        (rail * 1e3 * at, rail * 1e3 * (at + 20.0 / 220.0))
        for at in (8 / 220, 100 / 220, 192 / 220)
    ]
    spans = "".join(
        f'\n  {{ start = "{_n(low)} mm", end = "{_n(high)} mm" }},' for low, high in mounts
    )
    return _TEXT.format(
        name=name,
        duration=math.ceil(1e3 * duration(numbers)),
        mass=_n(numbers.mass),
        sizes=", ".join(f'"{_n(1e3 * side)} mm"' for side in numbers.size),
        xx=_n(numbers.mass * (b**2 + c**2) / 12.0),
        yy=_n(numbers.mass * (a**2 + c**2) / 12.0),
        zz=_n(numbers.mass * (a**2 + b**2) / 12.0),
        station=_n(station),
        y=_n(500.0 * b),
        z=_n(500.0 * c),
        pad=_n(pad),
        inset=_n(9.0 * scale),
        start=_n(start),
        end=_n(start + 1e3 * rail),
        leg=_n(24.0 * scale),
        thickness=_n(4.0 * scale),
        mounts=spans,
        peak=_n(numbers.thrust),
        width=_n(1e3 * numbers.burn_time / 6.0),
        centre=_n(1e3 * numbers.burn_time / 2.0),
        arm=_n(1e3 * a * 0.10 / 0.35),
        clearance=_n(1e3 * numbers.clearance),
    )


def _n(value: float) -> str:
    return f"{value:.6g}"


_TEXT = """\
# A launcher for tipoff. X runs along the rails to their open end, Y and Z across; the origin is the
# payload's mass centre. Every quantity is text with its unit. A table that is absent is an effect that
# is absent. What "tipoff new" assumed is listed under [provenance]: replace it by what you know.
name = "{name}"
description = "Made by tipoff new."
duration = "{duration} ms"  # until the payload has left the rail and its rates have settled

[payload]
mass = "{mass} kg"
size = [{sizes}]

[payload.inertia]  # about the mass centre; here of a box of uniform density
xx = "{xx} kg*m**2"
yy = "{yy} kg*m**2"
zz = "{zz} kg*m**2"
# xy, xz, yz: entries of the tensor, xy = -integral of x y dm; CAD often prints the other sign

[pads]  # one at each of the four corners of each station, with two faces that point outwards
stations = ["-{station} mm", "{station} mm"]  # X of the rear and of the front pads
corner = ["{y} mm", "{z} mm"]  # distance of the corners from the axis along Y and Z
length = "{pad} mm"
width = "{pad} mm"
inset = "{inset} mm"  # from the corner to the middle of a face, along the face and towards the axis
relief = "20 um"  # how far the edges of the crowned face lie behind its middle

[rail]  # four L sections, one around each edge of the payload, open at X = end
start = "{start} mm"
end = "{end} mm"
leg = "{leg} mm"
thickness = "{thickness} mm"
mounts = [  # where a rail is held, from its start{mounts}
]

[rail.material]  # aluminium 7075-T6
density = "2810 kg/m**3"
youngs_modulus = "72 GPa"
poisson_ratio = 0.33
yield_strength = "503 MPa"

[thrust]  # other kinds: gaussians (a sum), constant, measured (a CSV file)
kind = "gaussian"
peak = "{peak} N"
width = "{width} ms"  # standard deviation
centre = "{centre} ms"
arm = "{arm} mm"  # distance of the point of application behind the mass centre

[thrust_offset.misalignment]
axial = "0.1 deg"  # tilt of the thrust off +X
radial = "0 deg"  # clock angle of the tilt, from +Y towards +Z

# [thrust_offset.eccentricity]
# axial = "0.3 mm"  # distance of the line of thrust from the axis
# radial = "0 deg"  # clock angle, from +Z towards +Y

# [mass_offset.eccentricity]
# axial = "0.2 mm"
# radial = "0 deg"  # from +Z towards +Y

[contact]
clearance = "{clearance} mm"  # between each pad face and its wall
interface_stiffness = "1.8e12 N/m**3"  # pressure over approach: docs/interface_stiffness.md
law = "impact"  # from here on: constants of the model "springs"; tipoff calibrate finds them
exponent = 1.5
stiffness = "70000 N/mm**1.5"
damping = "60 N*s/mm"
damping_depth = "0.3 mm"

[friction]
static = 0.2
dynamic = 0.2
static_speed = "10 mm/s"
dynamic_speed = "20 mm/s"

# A free platform; without this table the rails are fixed.
# [platform]
# mass = "81 kg"
# mass_centre = {{ x = "-0.10 m" }}
# [platform.inertia]
# xx = "4.9 kg*m**2"
# yy = "4.9 kg*m**2"
# zz = "4.9 kg*m**2"

[conditions.tilt0]  # variants of the scene: tipoff run --condition tilt0,tilt45
"thrust_offset.misalignment.radial" = "0 deg"

[conditions.tilt45]
"thrust_offset.misalignment.radial" = "45 deg"

[conditions.tilt90]
"thrust_offset.misalignment.radial" = "90 deg"

[agreement]  # what tipoff report compares with finite elements
fitted = ["tilt0", "tilt90"]
held_out = ["tilt45"]
floor = ["tilt0"]
refined = ["tilt0"]

[provenance]
"payload.mass" = "given to tipoff new"
"payload.size" = "given to tipoff new"
"payload.inertia" = "assumed: uniform density"
"pads" = "assumed: proportions of the scene reference"
"rail" = "assumed: proportions of the scene reference"
"rail.end" = "given to tipoff new"
"rail.material" = "handbook, 7075-T6"
"thrust" = "given to tipoff new"
"thrust.arm" = "assumed"
"thrust_offset" = "assumed"
"contact" = "assumed: as the scene reference"
"contact.clearance" = "given to tipoff new"
"friction" = "assumed"
"""
