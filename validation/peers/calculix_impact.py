"""The sliding impact of ``impact_problem`` by the implicit dynamics of CalculiX.

Bar and mesh are those of the reference, in C3D8I. The block is a box of the same mass and moment of
inertia about y, a thousand times as stiff as the bar; its lower side holds the crowned pad. Contact is
surface to surface with a linear pressure over overclosure and Coulomb friction. Time is integrated
by the alpha method with equal steps.

Source of the method: Hilber, Hughes and Taylor, Earthquake Eng. Struct. Dyn. 5 (1977) 283-292.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets, read
from tipoff.meshes import bricks
from validation.peers import calculix
from validation.peers import impact_problem as case
from validation.peers.calculix import LINEAR
from validation.peers.case import Case

ALPHA = -0.05
STIFFER = 1e3  # stiffness of the block over that of the bar
_DIVISIONS = 16  # along each edge of the pad
STICK = 1e12  # N/m3, slope of friction over slip where it sticks
_BREADTH = 0.024  # m, the block along y


class Setting(NamedTuple):
    """Elements of the bar (m) in both codes, time step of CalculiX (s), factor of the interface."""

    size: float
    step: float
    factor: float


SETTINGS = {f"4 mm, {1e6 * step:g} us": Setting(4e-3, step, 1.0) for step in (4e-6, 2e-6)}


class Block(NamedTuple):
    """The block as a mesh around its mass centre."""

    points: np.ndarray  # (n,3) m
    cells: np.ndarray  # (e,8)
    pad: np.ndarray  # (m,4) facets
    density: float  # kg/m3
    mass: np.ndarray  # (n,) kg, share of each node


def block() -> Block:
    """A box whose lower side lies at the height of the pad."""
    tall = 2.0 * case.HEIGHT
    long = np.sqrt(12.0 * case.INERTIA / case.MASS - tall**2)
    lines = [
        bricks.divided(
            np.array([-0.5 * side, -0.5 * case.PAD, 0.5 * case.PAD, 0.5 * side]), (1, _DIVISIONS, 1)
        )
        for side in (long, _BREADTH)
    ]
    lines.append(np.array([-0.5 * tall, 0.5 * tall]))
    metal = np.ones([len(line) - 1 for line in lines], dtype=bool)
    points, cells = bricks.filled(lines, metal)
    density = case.MASS / (long * _BREADTH * tall)
    size = np.ptp(points[cells], axis=1).prod(axis=1)
    mass = np.bincount(cells.ravel(), np.repeat(density * size / 8.0, 8))
    within = (np.abs(points[:, :2]) < 0.5 * case.PAD + 1e-9).all(axis=1) & (points[:, 2] < 0.0)
    facets = boundary_facets(cells)
    pad = facets[within[facets].all(axis=1)]
    crown = case.RELIEF * ((points[:, :2] / (0.5 * case.PAD)) ** 4).sum(axis=1)
    points[:, 2] += np.where(within, crown, 0.0)
    return Block(points, cells, pad, density, mass)


def there(chosen: Setting) -> dict[str, float]:
    """The quantities of ``impact_problem.solve``."""
    bar, moved = read(case.bar(chosen.size)), block()
    answer = calculix.run(_deck(bar, moved, chosen))
    velocity = answer.table("velocities", len(moved.points), case.DURATION)[:, 1:]
    place = answer.table("displacements", len(moved.points), case.DURATION)[:, 1:] + moved.points
    share = moved.mass / moved.mass.sum()
    centre, mean = share @ place, share @ velocity
    apart, drift = place - centre, velocity - mean
    # about y, from the moments of the nodal masses, whose inertia is that of the trapezoidal rule
    spin = moved.mass @ (apart[:, 2] * drift[:, 0] - apart[:, 0] * drift[:, 2])
    inertia = moved.mass @ (apart[:, 2] ** 2 + apart[:, 0] ** 2)
    return {
        "rebound": float(mean[2]),
        "pitch rate": float(spin / inertia),
        "normal impulse": case.MASS * float(mean[2] + case.APPROACH),
        "friction impulse": case.MASS * float(mean[0] - case.SPEED),
        "cpu_s": answer.cpu_s,
    }


def _deck(bar: RailMesh, moved: Block, chosen: Setting) -> str:
    first, elements = len(bar.points), len(bar.cells)
    of = calculix.Solid(LINEAR, bar.points, bar.cells)
    placed = np.add(moved.points, [case.START, 0.0, 0.0])
    upper = calculix.Solid(LINEAR, placed, moved.cells)
    material = case.DENSITY, case.MODULUS, case.RATIO
    deck = calculix.head(of, material)
    deck += calculix.head(
        upper, (moved.density, STIFFER * case.MODULUS, 0.3), first=(first, elements), name="BLOCK"
    )
    deck += calculix.held(of, bar.surfaces["mount"])
    deck += calculix.surface("UPPER", of, bar.surfaces["contact_z"], 0)
    deck += calculix.surface("PAD", upper, moved.pad, elements)
    deck += "*SURFACE INTERACTION, NAME=INTERFACE\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
    deck += f"{chosen.factor * case.STIFFNESS:.13g}\n"
    deck += f"*FRICTION\n{case.FRICTION:g},{STICK:g}\n"
    deck += "*CONTACT PAIR, INTERACTION=INTERFACE, TYPE=SURFACE TO SURFACE\nPAD,UPPER\n"
    deck += "*INITIAL CONDITIONS, TYPE=VELOCITY\n"
    deck += f"NBLOCK,1,{case.SPEED:g}\nNBLOCK,3,{-case.APPROACH:g}\n"
    count = round(case.DURATION / chosen.step)
    deck += f"*STEP, INC={2 * count}\n*DYNAMIC, DIRECT, ALPHA={ALPHA:g}\n"
    deck += f"{chosen.step:.13g},{case.DURATION:.13g}\n"
    return deck + f"*NODE PRINT, NSET=NBLOCK, FREQUENCY={count}\nU,V\n*END STEP\n"


def _within(setting: str, quantity: str) -> float:
    """The remaining difference falls with the time step."""
    return 5e-3 if SETTINGS[setting].step > 2e-6 else 2e-3


def cases() -> tuple[Case, ...]:
    """The sliding impact at two time steps."""
    return (
        Case(
            name="calculix-impact",
            title="A rigid block slides along an elastic bar and strikes it, by implicit dynamics",
            inputs=case.inputs,
            matched="mesh and element of the bar, pad and its crown, interface stiffness, friction",
            unmatched=f"a block {STIFFER:g} times as stiff as the bar in place of a rigid one; "
            f"consistent masses; the alpha method ({ALPHA:g}), which damps; the pad's points",
            settings=tuple(SETTINGS),
            units=dict(case.UNITS),
            ours=lambda name: case.solve(SETTINGS[name].size, SETTINGS[name].factor),
            theirs=lambda name: there(SETTINGS[name]),
            within=_within,
        ),
    )
