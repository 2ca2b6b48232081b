"""Rail compliances for tests: made by hand or for the scene ``clamped``, poses that press them,
and the plain equations again."""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from tipoff import scenes
from tipoff.highfi import compliance
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi import system as systems
from tipoff.lowfi.contact import springs
from tipoff.lowfi.contact.compliant import loads, record, solution
from tipoff.lowfi.dynamics import equations
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance, pairs, patterns
from tipoff.mechanics.rail_compliance.patterns import powers
from tipoff.scenes import scene_model
from tipoff.scenes.rail_compliance import digest
from tipoff.scenes.scene import Scene

REFERENCE = scenes.load("clamped")
# the kernels of friction, without its forces
SMOOTH = {"friction.static": 0.0, "friction.dynamic": 0.0}


@cache
def reference_compliance() -> RailCompliance:
    """Those of ``REFERENCE``, from elements of 4 mm."""
    return compliance.condense(REFERENCE, 4e-3)


def handmade(scene: Scene, entries: dict, rail=None) -> RailCompliance:
    """Walls whose flexibility is zero except for ``entries``: (face, pattern, face, pattern) ->
    m/N, the same everywhere; one rail holds all faces, or ``rail`` (f,) gives the rail of each."""
    faces = scene_model.build(scene).faces
    count = faces.axis.size
    flexibility = np.zeros((2, count, PATTERNS, count, PATTERNS))
    for (i, a, j, b), value in entries.items():
        flexibility[:, i, a, j, b] = flexibility[:, j, b, i, a] = value
    half = np.column_stack([faces.half_length, faces.half_width])
    rail = np.zeros(count, dtype=np.int64) if rail is None else rail
    return RailCompliance(
        np.array([0.0, 1.0]),
        pairs.of_whole(flexibility, rail),
        rail,
        half,
        np.zeros((rail.max() + 1, 0)),
        np.zeros((2, count, PATTERNS, 0)),
        digest(scene),
    )


CELLS = 10  # along each edge of a pad face


def in_one_cell(monkeypatch) -> None:
    """From now on runs use compliant contact with one cell on each pad face."""
    build = record.build
    monkeypatch.setattr(
        record, "build", lambda *given, **named: build(*given, **named | {"cells": 1})
    )


class Pose(NamedTuple):
    """Places (m) and attitudes of payload and platform."""

    place: np.ndarray
    attitude: tuple
    base_place: np.ndarray
    base_attitude: tuple

    def moved(self, twist: np.ndarray, h: float) -> "Pose":
        """The pose after ``h`` of ``twist`` (12,): velocity and rate in body axes, of payload and
        platform."""
        turns = [
            rotation.product(q, rotation.exponential(tuple(h * w)))
            for q, w in ((self.attitude, twist[3:6]), (self.base_attitude, twist[9:]))
        ]
        return Pose(
            self.place + h * twist[:3], turns[0], self.base_place + h * twist[6:9], turns[1]
        )


def relative(
    model,
    travel: float,
    offset=(0.0, 0.0),
    attitude=(0.0, 0.0, 0.0),
    base=(0.0, 0.0, 0.0),
    turn=(0.0, 0.0, 0.0),
) -> Pose:
    """The payload ``travel`` (m) along the rails, ``offset`` (m) across them and turned by a
    rotation vector, all in the axes of a platform that is itself moved by ``base`` (m) and turned
    by ``turn``."""
    origin = np.array(model.platform.mass_centre)
    place = np.array(model.payload.mass_centre) - origin + [travel, *offset]
    base_attitude = rotation.exponential(turn)
    carried = np.array(rotation.rotate(rotation.matrix(base_attitude), tuple(place)))
    return Pose(
        origin + base + carried,
        rotation.product(base_attitude, rotation.exponential(attitude)),
        origin + base,
        base_attitude,
    )


def state_of(model, pose: Pose, twist: np.ndarray = np.zeros(12)) -> np.ndarray:
    """State (STATE_SIZE,) of both bodies at ``pose`` moving by ``twist`` (12,)."""
    state = np.zeros(slot.STATE_SIZE)
    for first, body, place, attitude, motion in (
        (slot.PAYLOAD, model.payload, pose.place, pose.attitude, twist[:6]),
        (slot.PLATFORM, model.platform, pose.base_place, pose.base_attitude, twist[6:]),
    ):
        slot.fill(
            state,
            first,
            body.inertia,
            tuple(place),
            tuple(motion[:3]),
            attitude,
            tuple(motion[3:]),
        )
    slot.put_together(model.payload.mass, model.platform.mass, state)
    return state


@kernel
def seen_from_platform(platform, payload, state):
    """Place (m) and rotation (nine numbers) of the payload in platform axes."""
    body = slot.motion(payload, state, slot.PAYLOAD)
    return springs.relative_pose(platform, body, slot.frame(platform, state))


@kernel
def add_compliant_contact(system, touching, state, out):
    """Add compliant contact alone to ``out``, the derivative of ``state``."""
    payload = system.payload
    bodies = equations.Bodies(
        slot.motion(payload, state, slot.PAYLOAD),
        slot.frame(system.platform, state),
        system.platform,
        system.friction,
        system.evaluated,
    )
    equations.add_compliant_contact(system.compliance, system.faces, touching, bodies, state, out)


def pressed(scene: Scene, compliance: RailCompliance, modes: int = 0):
    """Model and records of ``scene`` with a ``compliance``."""
    model = scene_model.build(scene)
    damping = scene.rail.damping and scene.rail.damping.record()
    return model, systems.build(
        model, compliance=record.build(compliance, model, CELLS, modes, damping)
    )


def forces_of(
    compliance: RailCompliance, model, cells: int, face: int, pose: Pose, displacement: np.ndarray
) -> np.ndarray:
    """P (p,) N of a face on a wall displaced by (p,) m: the equations of ``lowfi.contact.compliant.cells`` cell
    by cell, on a face without overhang."""
    faces, base = model.faces, rotation.matrices([pose.base_attitude])[0]
    turn, place = (
        base.T @ rotation.matrices([pose.attitude])[0],
        base.T @ (pose.place - pose.base_place),
    )
    axis, across, half = faces.axis[face], 3 - faces.axis[face], compliance.half[face]
    edges = np.linspace(-1.0, 1.0, cells + 1)
    node, crown = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges**5) / 5.0 / np.diff(edges)
    xi, eta = (grid.ravel() for grid in np.meshgrid(node, node, indexing="ij"))
    arms = np.zeros((xi.size, 3))
    arms[:, 0], arms[:, across] = half[0] * xi, half[1] * eta
    depth = faces.sign[face] * (
        (place + (faces.centre[face] + arms) @ turn.T)[:, axis] - faces.wall[face]
    )
    depth -= faces.relief[face] * np.add.outer(crown, crown).ravel()
    origin = np.array(model.platform.mass_centre) if model.platform else np.zeros(3)
    aside = (
        place + turn @ faces.centre[face] - faces.centre[face] - model.payload.mass_centre + origin
    )[across]
    ahead = (turn @ faces.centre[face] - faces.centre[face])[0]
    by_xi, by_eta = powers(compliance.degree).T
    phi = (xi[:, None] + ahead / half[0]) ** by_xi * (eta + aside / half[1])[:, None] ** by_eta
    area = 4.0 * np.abs(half).prod() / cells**2
    return model.interface_stiffness * area * phi.T @ np.maximum(0.0, depth - phi @ displacement)


def flexibility_at(compliance: RailCompliance, travel: float) -> np.ndarray:
    """(f,p,f,p) m/N between the stations."""
    every, whole = (
        pairs.whole(compliance.flexibility, compliance.rail),
        whole_at(compliance, travel),
    )
    on_part = compliance.on_part
    found = np.zeros(every.shape[1:])
    for first, second in np.argwhere(compliance.rail[:, None] == compliance.rail):
        values = every[:, first, :, second]
        values = on_part[:, first].swapaxes(1, 2) @ values @ on_part[:, second]
        own = between(compliance, values, travel, first, second)
        found[first, :, second] = whole[first] @ own @ whole[second].T
    return found


def whole_at(compliance: RailCompliance, travel: float) -> np.ndarray:
    """Matrices (f,p,p) from patterns of the parts of the faces with a wall to those of whole faces. In
    the reference scene the parts bend at stations only."""
    part = [
        [np.interp(travel, compliance.travel, column) for column in face.T]
        for face in compliance.part.swapaxes(0, 1)
    ]
    turned = patterns.on_part(np.array(part), compliance.degree).swapaxes(1, 2)
    return np.linalg.inv(turned)


def between(compliance: RailCompliance, values: np.ndarray, travel: float, *faces) -> np.ndarray:
    """``values`` (s,...) of ``faces`` between the stations: cubic splines that end at the stations at
    which a part bends."""
    bends = np.abs(np.diff(compliance.part[:, list(faces)], 2, axis=0)).max(axis=(1, 2)) > 1e-9
    ends = np.concatenate([[0], np.flatnonzero(bends) + 1, [len(values) - 1]])
    last = int(np.clip(np.searchsorted(compliance.travel[ends], travel), 1, ends.size - 1))
    own = slice(ends[last - 1], ends[last] + 1)
    return CubicSpline(compliance.travel[own], values[own])(travel)


CLEARANCE = REFERENCE.contact.clearance
# What the pads meet: way (m), way across beyond the clearance (m), attitude (rad).
POSES = {
    "one leg": (0.035, (8e-6, -1e-4), (0.0, 0.0, 0.0)),
    "both legs": (0.035, (6.3e-6, 9.3e-6), (0.0, 1e-6, -1e-6)),
    "all faces of a rail, tilted": (0.022, (2e-5, 3e-5), (2e-5, 8e-5, -6e-5)),
    "rails of both sides": (0.04, (-2e-4, -2e-4), (0.0, 3.1e-3, 2.9e-3)),
    "front pads over the end": (0.0513, (1e-5, 2e-5), (0.0, -2e-5, 1e-5)),
    "rear pads over the end": (0.2071, (4e-5, 3e-5), (1e-5, 1e-5, -3e-5)),
    "rear pads over the begin": (-0.0042, (4e-5, 3e-5), (1e-5, -1e-5, 3e-5)),
}
BASES = {
    "in place": ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "moved and turned": ((0.3, -0.2, 0.1), (0.4, -0.3, 0.5)),
}


def pose_of(model, name, base=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))):
    travel, beyond, attitude = POSES[name]
    return relative(model, travel, [CLEARANCE + way for way in beyond], attitude, *base)


def solved(system, model, pose, rail, active=None, modes=()):
    """Number of faces of a rail solved for at ``pose``, which ``system.compliance.workspace`` then holds;
    ``modes`` are those of the state."""
    state = np.append(state_of(model, pose), modes)
    place, turn = seen_from_platform(system.platform, system.payload, state)
    active = np.ones(len(system.faces), dtype=np.bool_) if active is None else active
    return solution.solve(system.compliance, system.faces, rail, active, place, turn, state)


def energy(system, model, pose, modes=()) -> float:
    return sum(
        loads.energy(system.compliance, solved(system, model, pose, rail, None, modes))
        for rail in range(len(system.compliance.members))
    )


def derivative(system, model, pose, twist, modes=()):
    """What compliant contact alone adds to the derivative of the state at ``pose`` and ``twist``."""
    state, every = (
        np.append(state_of(model, pose, twist), modes),
        np.ones(len(system.faces), dtype=np.bool_),
    )
    out = np.zeros(state.size)
    add_compliant_contact(system, every, state, out)
    return out


def generalised(pose, out):
    """Generalised forces (12,) of twists, from forces and their moments about the origin."""
    found = []
    for (first, about_origin), place, attitude in zip(
        slot.BODIES,
        (pose.place, pose.base_place),
        (pose.attitude, pose.base_attitude),
        strict=True,
    ):
        force, moment = out[first + slot.VELOCITY :][:3], out[about_origin:][:3]
        about = tuple(moment - np.cross(place, force))
        found += [force, rotation.unrotate(rotation.matrix(attitude), about)]
    return np.concatenate(found)
