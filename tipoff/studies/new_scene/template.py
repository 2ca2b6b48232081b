"""A commented scene file of a launcher from a few numbers.

The payload is a box of uniform density in four L rails. One pulse of thrust, or a measured thrust, pushes
it with a tilt of 0.1 deg. All other values have the proportions of the scene ``clamped`` and the
provenance "assumed".
"""

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tomlkit

from tipoff.faults import Fault, SceneError
from tipoff.scenes.effects.measured import is_of_a_clock, read_curve
from tipoff.scenes.reading import FORMAT

_WIDTH = 0.2  # m, of the payload of the scene ``clamped``, whose sections are scaled
_RAILS = 4  # one along each edge of the payload, with one pad at each station


class Numbers(NamedTuple):
    """Mass (kg) and outer sizes (m) of the payload, travel along the rail (m), clearance (m), peak
    of the thrust (N), time in which it rises and falls (s); a file with the curve of the thrust in
    place of both; number of pads."""

    mass: float = 9.9
    size: tuple[float, float, float] = (0.35, 0.20, 0.20)
    rail_length: float = 0.22
    clearance: float = 0.25e-3
    thrust: float = 6000.0
    burn_time: float = 0.024
    thrust_curve: Path | None = None
    pads: int = 8

    def faults(self) -> list[Fault]:
        """Faults of numbers from which no launcher can be made."""
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
        return found + _of_pads(self) + curve_faults(self.thrust_curve)

    @property
    def pad(self) -> float:
        """Width of a pad (m), and its length where there are several on a rail."""
        return 0.016 * min(self.size[1:]) / _WIDTH

    @property
    def station(self) -> float:
        """Distance (m) of the middle of the outermost pads from the mass centre, along the rail."""
        return self.size[0] * 0.08 / 0.35


def pads_faults(count: int) -> list[Fault]:
    """The fault of a number of pads that is no multiple of four."""
    if count >= _RAILS and count % _RAILS == 0:
        return []
    expected = "4, 8, 12 or another multiple of 4: each of the four rails holds as many pads"
    return [Fault("--pads", "value", str(count), expected)]


def clock_time(file: Path) -> str | None:
    """First time of a curve whose times are those of a clock; None for another one."""
    curve = read_curve(file)
    return f"{curve.time[0]:.15g} s" if is_of_a_clock(curve) else None


def _of_pads(numbers: Numbers) -> list[Fault]:
    """Faults of the number of pads: no multiple of four, or too many for the length."""
    if (faults := pads_faults(numbers.pads)) or min(numbers.size) <= 0.0:
        return faults
    most = _RAILS * max(1, int(2.0 * numbers.station / numbers.pad) + 1)
    if numbers.pads <= most:
        return []
    expected = f"at most {most}: more pads overlap on a payload of this length"
    return [Fault("--pads", "value", str(numbers.pads), expected)]


def curve_faults(file: Path | None) -> list[Fault]:
    """Faults of a curve of the thrust: not readable, or without impulse; none without a file."""
    if file is None:
        return []
    try:
        curve = read_curve(file)
    except ValueError as fault:
        return [Fault("--thrust-curve", "file", str(file), str(fault))]
    if (impulse := float(np.trapezoid(curve.force, curve.time))) <= 0.0:
        expected = f"a curve with an impulse above zero (this one has {impulse:.4g} N s)"
        return [Fault("--thrust-curve", "file", str(file), expected)]
    return []


def text(name: str, numbers: Numbers, folder: Path = Path()) -> str:
    """The scene as TOML, for a file in ``folder``. Raises SceneError, every fault listed."""
    if faults := numbers.faults():
        raise SceneError(faults)
    a, b, c = numbers.size
    scale, rail = min(b, c) / _WIDTH, numbers.rail_length
    start = -1e3 * (numbers.station + 0.5 * numbers.pad)
    mounts = [
        (rail * 1e3 * at, rail * 1e3 * (at + 20.0 / 220.0))
        for at in (8 / 220, 100 / 220, 192 / 220)
    ]
    spans = "".join(
        f'\n  {{ start = "{_n(low)} mm", end = "{_n(high)} mm" }},' for low, high in mounts
    )
    return _TEXT.format(
        format=FORMAT,
        name=name,
        mass=_n(numbers.mass),
        sizes=", ".join(f'"{_n(1e3 * side)} mm"' for side in numbers.size),
        xx=_n(numbers.mass * (b**2 + c**2) / 12.0),
        yy=_n(numbers.mass * (a**2 + c**2) / 12.0),
        zz=_n(numbers.mass * (a**2 + b**2) / 12.0),
        **_pads(numbers),
        y=_n(500.0 * b),
        z=_n(500.0 * c),
        pad=_n(1e3 * numbers.pad),
        inset=_n(9.0 * scale),
        start=_n(start),
        end=_n(start + 1e3 * rail),
        leg=_n(24.0 * scale),
        thickness=_n(4.0 * scale),
        mounts=spans,
        thrust=_thrust(numbers, folder),
        arm=_n(1e3 * a * 0.10 / 0.35),
        clearance=_n(1e3 * numbers.clearance),
    )


def _pads(numbers: Numbers) -> dict[str, str]:
    """Positions and length of the pads along the rail. A single pad on each rail is as long as two
    pads with their distance, because only this pad keeps the payload from turning about Y and Z."""
    if numbers.pads == _RAILS:
        length = _n(1e3 * (2.0 * numbers.station + numbers.pad))
        return {
            "stations": '"0 mm"',
            "length": f'"{length} mm"  # long: a single pad on a rail must guide the payload '
            "alone\n# The model springs has one point for a pad, which cannot guide it: use compliant, "
            "the default.",
        }
    places = 1e3 * np.linspace(-numbers.station, numbers.station, numbers.pads // _RAILS)
    return {
        "stations": ", ".join(f'"{_n(place)} mm"' for place in places),
        "length": f'"{_n(1e3 * numbers.pad)} mm"',
    }


def _thrust(numbers: Numbers, folder: Path) -> str:
    """The keys that differ between a pulse and a measured curve."""
    if numbers.thrust_curve is not None:
        path = os.path.relpath(numbers.thrust_curve.resolve(), folder.resolve())
        file, begin = tomlkit.item(path).as_string(), clock_time(numbers.thrust_curve)
        ignition = f'ignition = "{begin}"  # where the scene begins\n' if begin else ""
        return (
            "[thrust]  # other kinds: gaussian (a pulse), gaussians (a sum), constant\n"
            'kind = "measured"\n'
            f"file = {file}  # relative to this file\n"
            f"{ignition}"
            'use = "curve"  # "fit": use the Gaussian that is fitted to the points'
        )
    return (
        "[thrust]  # other kinds: gaussians (a sum), constant, measured (a CSV file)\n"
        'kind = "gaussian"\n'
        f'peak = "{_n(numbers.thrust)} N"\n'
        f'width = "{_n(1e3 * numbers.burn_time / 6.0)} ms"  # standard deviation\n'
        f'centre = "{_n(1e3 * numbers.burn_time / 2.0)} ms"'
    )


def _n(value: float) -> str:
    return f"{value:.6g}"


_TEXT = """\
# A launcher for tipoff. X runs along the rails to their open end, Y and Z across; the origin is the
# payload's mass centre. Every quantity is text with its unit. An absent table is an absent effect.
# [provenance] lists the values that "tipoff new" assumed: replace them by your values.
format = {format}
name = "{name}"
description = "Made by tipoff new."

[payload]
mass = "{mass} kg"
size = [{sizes}]

[payload.inertia]  # about the mass centre; here of a box of uniform density
xx = "{xx} kg*m**2"
yy = "{yy} kg*m**2"
zz = "{zz} kg*m**2"
# xy, xz, yz: entries of the tensor, xy = -integral of x y dm; CAD often prints the other sign

[pads]  # one at each of the four corners of each station, with two faces that point outwards
stations = [{stations}]  # X of the pads, from the rear to the front
corner = ["{y} mm", "{z} mm"]  # distance of the corners from the axis along Y and Z
length = {length}
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

{thrust}
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

[studies]
errors = "paper"  # random errors of a launch, as in the paper; or a file of distributions of your own

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
"pads" = "assumed: proportions of the scene clamped"
"rail" = "assumed: proportions of the scene clamped"
"rail.end" = "given to tipoff new"
"rail.material" = "handbook, 7075-T6"
"thrust" = "given to tipoff new"
"thrust.arm" = "assumed"
"thrust_offset" = "assumed"
"contact" = "assumed: as the scene reference"
"contact.clearance" = "given to tipoff new"
"friction" = "assumed"
"""
