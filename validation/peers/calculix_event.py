"""The first contact of scene ``clamped``, condition phi35, by the implicit dynamics of CalculiX.

The event starts just before pad 3 touches its rail. It ends when the pad leaves, just before a second pad
touches. The payload starts with the motion of the reference at that time. There is no thrust, and the
platform is fixed. The rail is that of the reference in C3D8I. The payload is a box of one stiff element
along its principal axes, and its size gives the inertia. Linear equations connect the pad to the box.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from tipoff import highfi
from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.kernels import rotation
from tipoff.meshes import bricks
from tipoff.scenes import scene_model
from tipoff.scenes.scene import Scene, load
from validation.peers import calculix
from validation.peers.calculix import LINEAR
from validation.peers.calculix_impact import ALPHA, STICK, STIFFER
from validation.peers.calculix_rail import constants
from validation.peers.case import OURS, Case, Unfinished, require_ours
from validation.peers.springs_problem import AXES

SIZE = 4e-3  # m, elements
DURATION = 1.25e-3  # s
# Motion of the reference on elements of 4 mm at 28.75 ms, relative to the platform: m, rad, m/s, rad/s
START = {
    "position": (0.113918891, 1.48701497e-4, 1.04544632e-4),
    "attitude": (-7.97507e-5, 7.55368e-4, -1.126951e-3),
    "velocity": (6.80824249, 8.63795859e-3, 6.0810609e-3),
    "rate": (-4.76838e-3, 4.51826e-2, -6.740348e-2),
}
FACE = 6  # the face of pad 3 along +y
_DIVISIONS, _PLATE = 16, 2e-3  # along each edge of the pad; m, its thickness
SETTINGS = {f"4 mm, {1e6 * step:g} us": step for step in (2e-5, 1e-5)}
UNITS = {
    "normal impulse": "N s",
    "friction impulse": "N s",
    **dict.fromkeys((f"rate {axis}" for axis in AXES), "deg/s"),
}


class Body(NamedTuple):
    """A mesh of the payload in scene axes at the start."""

    points: np.ndarray  # (n,3) m
    cells: np.ndarray  # (e,8)


@cache
def scene() -> Scene:
    """The event as a scene of its own."""
    found = load("clamped").condition("phi35")
    thrust = {"kind": "constant", "force": 0.0, "duration": DURATION}
    initial = {name: dict(zip(AXES, values)) for name, values in START.items()}
    return found.replace(
        {
            "platform": "absent",
            "thrust_offset": "absent",
            "thrust": thrust,
            "initial": initial,
            "duration": DURATION,
            "output.interval": DURATION / 125,
        }
    )


def here() -> dict[str, float]:
    """Impulses on the payload and its rates at the end, by the reference."""
    found = highfi.run(scene(), highfi.Numerics(element_size=SIZE))
    touched = np.flatnonzero(np.abs(found.pad_force).max(axis=(0, 2)) > 0.0)
    require_ours(found, "time_limit", DURATION)
    if touched.tolist() != [FACE]:
        raise Unfinished(f"{OURS}: faces {touched.tolist()} touch, asked was {[FACE]}")
    change = scene().payload.mass * (found.velocity[-1] - START["velocity"])
    return _named(change, found.rate[-1]) | {"cpu_s": float(found.cost["cpu_s"])}


def _named(change: np.ndarray, rate: np.ndarray) -> dict[str, float]:
    rates = np.rad2deg(rate).tolist()
    named = {f"rate {axis}": value for axis, value in zip(AXES, rates)}
    return {"normal impulse": float(change[1]), "friction impulse": float(change[0])} | named


def there(step: float) -> dict[str, float]:
    """The same by CalculiX with steps of ``step`` (s)."""
    rail, box, pad = _rail(), _box(), _pad()
    answer = calculix.run(_deck(rail, box, pad[0], pad[1], step))
    velocity = answer.table("velocities", len(box.points), DURATION)[:, 1:]
    apart = answer.table("displacements", len(box.points), DURATION)[:, 1:] + box.points
    apart = apart - apart.mean(axis=0)
    # v = mean + w x r, by least squares
    cross = np.array([[[0, r[2], -r[1]], [-r[2], 0, r[0]], [r[1], -r[0], 0]] for r in apart])
    drift = velocity - velocity.mean(axis=0)
    rate, *_ = np.linalg.lstsq(cross.reshape(-1, 3), drift.ravel())
    change = scene().payload.mass * (velocity.mean(axis=0) - START["velocity"])
    turned = _turn(np.add(START["attitude"], DURATION * np.array(START["rate"])))
    return _named(change, turned.T @ rate) | {"cpu_s": answer.cpu_s}


def _turn(vector: np.ndarray) -> np.ndarray:
    quaternion = rotation.exponential(tuple(float(value) for value in vector))
    return np.array(rotation.matrix(quaternion)).reshape(3, 3)


def _placed(points: np.ndarray) -> np.ndarray:
    """Body axes to scene axes at the start."""
    return np.add(points @ _turn(np.array(START["attitude"])).T, START["position"])


def _rail() -> RailMesh:
    mesh = highfi.prepare(scene(), highfi.Numerics(element_size=SIZE))
    return next(
        rail for rail in pieces.pieces(mesh) if (rail.points[:, 1:].mean(axis=0) > 0.0).all()
    )


def _box() -> Body:
    """One element along the principal axes with the payload's inertia: m (b^2 + c^2) / 12 about
    the first one."""
    payload = scene_model.build(scene()).payload
    principal, axes = np.linalg.eigh(payload.inertia)
    size = np.sqrt(6.0 / payload.mass * (principal.sum() - 2.0 * principal))
    axes = axes * [1.0, 1.0, np.linalg.det(axes)]
    return Body(_placed((bricks.CUBE - 0.5) * size @ axes.T), np.arange(8)[None])


def _pad() -> tuple[Body, np.ndarray]:
    """A plate whose outer side is the crowned face, and the facets of that side."""
    faces = scene_model.build(scene()).faces
    centre = faces.centre[FACE]
    half = np.array([faces.half_length[FACE], faces.half_width[FACE]])
    lines = [
        np.linspace(-half[0], half[0], _DIVISIONS + 1),
        np.array([-_PLATE, 0.0]),
        np.linspace(-half[1], half[1], _DIVISIONS + 1),
    ]
    points, cells = bricks.filled(lines, np.ones((_DIVISIONS, 1, _DIVISIONS), dtype=bool))
    outer = points[:, 1] == 0.0
    facets = boundary_facets(cells)
    crown = faces.relief[FACE] * ((points[:, [0, 2]] / half) ** 4).sum(axis=1)
    points[:, 1] -= np.where(outer, crown, 0.0)
    return Body(_placed(points + centre), cells), facets[outer[facets].all(axis=1)]


def _deck(rail: RailMesh, box: Body, pad: Body, facets: np.ndarray, step: float) -> str:
    contact, friction, material = scene().contact, scene().friction, scene().rail.material
    assert contact is not None and friction is not None
    modulus = STIFFER * material.youngs_modulus
    volume = abs(np.linalg.det(box.points[[1, 3, 4]] - box.points[0]))
    of, upper = calculix.Solid(LINEAR, rail.points, rail.cells), calculix.Solid(LINEAR, *pad)
    nodes, elements = len(rail.points), len(rail.cells)
    density = scene().payload.mass / volume
    deck = calculix.head(of, constants(material))
    deck += calculix.head(
        calculix.Solid(LINEAR, *box),
        (density, modulus, 0.0),
        first=(nodes, elements),
        name="BOX",
    )
    deck += calculix.head(
        upper, (1e-6 * density, modulus, 0.0), first=(nodes + 8, elements + 1), name="PAD"
    )
    deck += _hung(box, pad, facets, nodes)
    deck += calculix.held(of, rail.surfaces["mount"])
    deck += calculix.surface("WALL", of, rail.surfaces["contact_y"], 0)
    deck += calculix.surface("FACE", upper, facets, elements + 1)
    deck += "*SURFACE INTERACTION, NAME=INTERFACE\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
    deck += f"{contact.series_stiffness():.13g}\n*FRICTION\n{friction.dynamic:g},{STICK:g}\n"
    deck += "*CONTACT PAIR, INTERACTION=INTERFACE, TYPE=SURFACE TO SURFACE\nFACE,WALL\n"
    deck += "*INITIAL CONDITIONS, TYPE=VELOCITY\n" + _flying(box, pad, nodes)
    count = round(DURATION / step)
    deck += f"*STEP, INC={2 * count}\n*DYNAMIC, DIRECT, ALPHA={ALPHA:g}\n"
    deck += f"{step:.13g},{DURATION:.13g}\n"
    return deck + f"*NODE PRINT, NSET=NBOX, FREQUENCY={count}\nU,V\n*END STEP\n"


def _hung(box: Body, pad: Body, facets: np.ndarray, nodes: int) -> str:
    """Equations that move the inner side of the pad with the box: the trilinear displacement of the
    box is extended beyond the box."""
    inner = np.setdiff1d(np.arange(len(pad.points)), facets)
    edges = box.points[[1, 3, 4]] - box.points[0]
    local = np.linalg.solve(edges.T, (pad.points[inner] - box.points[0]).T).T
    weight = np.where(bricks.CUBE == 1, local[:, None], 1.0 - local[:, None]).prod(axis=2)
    lines = []
    for node, shares in zip(inner, weight):
        for axis in range(1, 4):
            terms = [f"{nodes + 8 + node + 1},{axis},-1"]
            terms += [f"{nodes + a + 1},{axis},{share:.13g}" for a, share in enumerate(shares)]
            rows = [",".join(terms[first : first + 4]) for first in range(0, len(terms), 4)]
            lines.append(f"*EQUATION\n{len(terms)}\n" + "\n".join(rows))
    return "\n".join([*lines, ""])


def _flying(box: Body, pad: Body, nodes: int) -> str:
    """Initial velocities of box and pad as of one rigid body."""
    rate = _turn(np.array(START["attitude"])) @ START["rate"]
    points = np.vstack([box.points, pad.points])
    velocity = START["velocity"] + np.cross(rate, points - START["position"])
    return "".join(
        f"{nodes + number + 1},{axis + 1},{value:.13g}\n"
        for number, row in enumerate(velocity)
        for axis, value in enumerate(row)
    )


def _within(setting: str, quantity: str) -> float:
    """The rate about z is the difference of two rates that nearly cancel."""
    return 2e-2 if quantity == "rate z" else 3e-3


def cases() -> tuple[Case, ...]:
    """The event at two time steps."""
    return (
        Case(
            name="calculix-event",
            title="First contact of scene `clamped`, condition phi35: pad 3 on its rail",
            inputs=lambda: (
                {"scene": "clamped", "condition": "phi35", "duration_s": DURATION}
                | {name: list(values) for name, values in START.items()}
            ),
            matched="mesh and element of the rail, mass and inertia of the payload, pad and its "
            "crown, interface stiffness, friction, motion at the start; platform fixed, no thrust",
            unmatched=f"a payload {STIFFER:g} times as stiff as the rail in place of a rigid one; "
            f"consistent masses; the alpha method ({ALPHA:g}), which damps; small rotations; the "
            "pad's points",
            settings=tuple(SETTINGS),
            units=UNITS,
            ours=lambda name: here(),
            theirs=lambda name: there(SETTINGS[name]),
            within=_within,
        ),
    )
