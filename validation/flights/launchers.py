"""Scenes of the two launchers: a rocket on two rail guides in a T-slot rail, and what is not known of it.

X is along the rail, Z from the rail to the rocket, and the origin is the mass centre before the start, as on
the scene ``rocket_rail`` of the catalogue. What is published is a number of ``Launcher``. What is not published
is drawn (``PRIORS`` and ``Launcher.variants``), with the reason beside it. These ranges were written down before
any run was compared with a record.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff.scenes.scene import Scene, load

GRAVITY = 9.80665  # m/s2
LONGER = 60e-3  # m, length of a clamp


@dataclass(frozen=True)
class Variant:
    """Places that are not known and need a rail compliance of their own. ``rear``, ``front``: guides from
    the mass centre (m). ``foot``: rail below the rear guide at the start (m). ``spacing``: between clamps (m).
    ``width``: of the square profile (m)."""

    rear: float
    front: float
    foot: float
    spacing: float
    width: float


@dataclass(frozen=True)
class Launcher:
    """What is published of a launch. ``mass`` (kg), ``roll`` and ``transverse`` inertia (kg m2) at the start,
    ``arm`` of the thrust behind the mass centre (m), ``rail`` (m), ``elevation`` (rad), ``until``: instant
    after which the thrust is cut, behind every exit (s)."""

    name: str
    mass: float
    roll: float
    transverse: float
    arm: float
    rail: float
    elevation: float
    until: float
    variants: tuple[Variant, ...]


# Launch 12: 34 to 35 kg; inertias and mass centre of its design file. Guides are usually one near the mass
# centre and one near the tail, which is 1.3 to 1.7 m behind it. The rear guide stands on the foot of the rail or
# up to 0.3 m above it. A rail of 3.9 m has two to five clamps. The profile has 40 mm (1515 and 4040)
# to 50 mm; profiles of 80 mm have two slots, which the section cannot draw.
PSAS = Launcher(
    "psas_l12",
    mass=34.5,
    roll=0.1034,
    transverse=54.27,
    arm=1.6,
    rail=3.9,
    elevation=np.radians(90.0),
    until=0.45,
    variants=(
        Variant(rear=-1.4, front=0.0, foot=0.1, spacing=0.9, width=0.04),
        Variant(rear=-1.2, front=0.3, foot=0.2, spacing=1.8, width=0.04),
        Variant(rear=-1.6, front=-0.2, foot=0.3, spacing=1.2, width=0.05),
        Variant(rear=-1.4, front=0.2, foot=0.05, spacing=2.4, width=0.045),
    ),
)
# Hedy: dry 17.2 kg with its centre 1.813 m from the tail; half of the 6.8 kg left at 1.4 s in each tank gives
# 24.0 kg (23.7 kg in the mean over the 0.64 s on the rail), a centre at 1.70 m and 19.7 kg m2. Buttons are
# published: 1.646 and 0.305 m from the tail.
HEDY = Launcher(
    "hedy_2025",
    mass=23.7,
    roll=0.0255,
    transverse=19.7,
    arm=1.7,
    rail=11.0,
    elevation=np.radians(84.0),
    until=0.95,
    variants=(
        Variant(rear=-1.395, front=-0.054, foot=0.2, spacing=1.2, width=0.04),
        Variant(rear=-1.395, front=-0.054, foot=0.3, spacing=1.8, width=0.05),
    ),
)
LAUNCHERS = (PSAS, HEDY)

# key: low, high, whether the logarithm is uniform, reason
PRIORS = {
    "play": (
        0.2e-3,
        2e-3,
        True,
        "m in all, half of it on each side: fits of buttons in slots, unknown",
    ),
    "misalignment": (0.0, 0.25, False, "deg, of the thrust: nozzle and motor mount"),
    "thrust_offset": (0.0, 2e-3, False, "m, of the thrust: centring rings"),
    "mass_offset": (0.0, 4e-3, False, "m, of the mass centre: parts on one side of the body"),
    "friction": (0.1, 0.4, False, "plastic or aluminium on anodised aluminium"),
    "mass": (0.985, 1.015, False, "share: scales, propellant, place of the record in the burn"),
    "roll": (0.8, 1.25, True, "share of the roll inertia: from a design file"),
    "orientation": (0.0, 360.0, False, "deg, of the rail about the axis of the sensor"),
}
ANGLES = ("misalignment_angle", "thrust_offset_angle", "mass_offset_angle")  # uniform, 0 to 360 deg


def draws(count: int, seed: int) -> list[dict[str, float]]:
    """``count`` draws of all unknowns but the places."""
    generator, found = np.random.default_rng(seed), []
    for _ in range(count):
        one = {}
        for name, (low, high, logarithmic, _reason) in PRIORS.items():
            share = generator.random()
            one[name] = low * (high / low) ** share if logarithmic else low + (high - low) * share
        for name in ANGLES:
            one[name] = 360.0 * generator.random()
        found.append(one)
    return found


def scene(launcher: Launcher, variant: Variant, thrust: Path, folder: Path, number: int) -> Scene:
    """The scene of a launcher with the places of ``variant`` and the curve of the file ``thrust``; its
    file is written into ``folder``."""
    path = folder / f"{launcher.name}_{number}.toml"
    path.write_text(_text(launcher, variant, thrust), encoding="utf-8")
    return load(path)


def changes(launcher: Launcher, draw: dict[str, float]) -> dict[str, object]:
    """The overrides of one draw, SI and radians."""
    side = 0.5 * draw["play"]
    roll = launcher.roll * draw["roll"]
    return {
        "contact.clearance": side,
        "initial.position.z": -side if launcher.elevation < np.radians(89.0) else 0.0,
        "thrust_offset.misalignment.axial": f"{draw['misalignment']} deg",
        "thrust_offset.misalignment.radial": f"{draw['misalignment_angle']} deg",
        "thrust_offset.eccentricity.axial": draw["thrust_offset"],
        "thrust_offset.eccentricity.radial": f"{draw['thrust_offset_angle']} deg",
        "mass_offset.eccentricity.axial": draw["mass_offset"],
        "mass_offset.eccentricity.radial": f"{draw['mass_offset_angle']} deg",
        "friction.static": draw["friction"],
        "friction.dynamic": draw["friction"],
        "payload.mass": launcher.mass * draw["mass"],
        "payload.inertia.xx": roll,
    }


def _text(launcher: Launcher, variant: Variant, thrust: Path) -> str:
    start = variant.rear - variant.foot
    clamps = np.arange(0.1, launcher.rail - 0.05, variant.spacing)
    mounts = "".join(
        f"  {{ start = '{1e3 * at:.0f} mm', end = '{1e3 * (at + LONGER):.0f} mm' }},\n"
        for at in clamps
    )
    half = 500.0 * variant.width  # mm
    lip = -43.25
    pads = "".join(_guide(at) for at in (variant.rear, variant.front))
    across = -GRAVITY * np.cos(launcher.elevation)
    return f"""extends = "rocket_rail"
name = "{launcher.name}"
description = "Measured launch {launcher.name}."
buttons = "absent"
conditions = "absent"
agreement = "absent"

[payload]
mass = "{launcher.mass} kg"
size = ["3.7 m", "160 mm", "160 mm"]

[payload.inertia]
xx = "{launcher.roll} kg*m**2"
yy = "{launcher.transverse} kg*m**2"
zz = "{launcher.transverse} kg*m**2"

[rail]
start = "{start:.4f} m"
end = "{start + launcher.rail:.4f} m"
at = ["0 mm", "{lip - half:.3f} mm"]
clearance = "0.25 mm"
leg = "6 mm"
thickness = "4.5 mm"
stretch = 3
mounts = [
{mounts}]
mounted = [["{0.6 * half:.3f} mm", "{-half:.3f} mm"], ["{-0.6 * half:.3f} mm", "{-half:.3f} mm"]]

[rail.section]
width = "{2.0 * half:.3f} mm"
web = "{2.5 if half < 21.0 else 3.0} mm"
depth = "{12.5 if half < 21.0 else 14.0} mm"

[thrust]
kind = "measured"
file = "{thrust.name}"
arm = "{launcher.arm} m"
reaction = "exhaust"

[thrust_offset.misalignment]
axial = "0 deg"
radial = "0 deg"

[thrust_offset.eccentricity]
axial = "0 mm"
radial = "0 deg"

[mass_offset.eccentricity]
axial = "0 mm"
radial = "0 deg"

[gravity]
x = "{-GRAVITY * np.sin(launcher.elevation):.5f} m/s**2"
z = "{across:.5f} m/s**2"

[contact]
clearance = "0.25 mm"

[output]
interval = "0.5 ms"

[studies]
element_size = "20 mm"

{pads}"""


def _guide(at: float) -> str:
    """Six pads of a guide at ``at`` (m): flange, head and neck, as on the scene ``rocket_rail``."""
    places = (
        (5.75, -43.0, "-z", 3),
        (-5.75, -43.0, "-z", 3),
        (5.75, -48.0, "+z", 3),
        (-5.75, -48.0, "+z", 3),
        (3.75, -45.5, "+y", 4),
        (-3.75, -45.5, "-y", 4),
    )
    return "".join(
        f"""[[pads]]
position = ["{at:.4f} m", "{y} mm", "{z} mm"]
normals = ["{normal}"]
length = "8 mm"
width = "{width} mm"
relief = "20 um"

"""
        for y, z, normal, width in places
    )
