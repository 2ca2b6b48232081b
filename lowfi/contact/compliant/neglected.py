"""Estimated change of the rates due to the modes of the rails, all treated as quasi-static in a run,
from the forces of the run.

The force of the pads on a mode m, linear between the ends of steps, drives a separate oscillator,
exactly::

    f_m = sum_ia S_iam P_ia,    q_m'' + d_m q_m' + omega_m^2 q_m = f_m

with the shapes S of ``modes``, those of pressure and friction. A quasi-static mode has
q_m = f_m / omega_m^2: no energy stays in it after the pads leave. The oscillator keeps
E_m = (q_m'^2 + omega_m^2 q_m^2) / 2. For a half-sine of duration T on a mode of frequency f at rest,
the closed form is the residual shock spectrum (Harris' Shock and Vibration Handbook, chapter on shock
response spectra)::

    omega sqrt(2 E) / F = |4 f T cos(pi f T) / (1 - 4 f^2 T^2)|

This energy is missing, or in excess, when the pad leaves the wall at the speed v. With the
effective mass M of both bodies at that pad, along its normal n, the impulse changes by dJ, and the
rate by::

    dJ = M |v - sqrt(max(0, v^2 - 2 dE / M))|,    d omega = |I^-1 (arm x n)| dJ

where dE is the change of E_m in this contact: a wall that still vibrates from an earlier contact
may return energy. The sum over all contacts is the effect of the mode. It is an estimate: later
contacts may enlarge it, and the phases of several modes may cancel.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.kernels.memory import zeros
from tipoff.kernels.reference import by_reference
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import modes, parts, patterns
from tipoff.lowfi.contact.compliant.free_vibration import is_pressed, oscillated
from tipoff.lowfi.contact.compliant.record import Compliance, drag_of
from tipoff.lowfi.contact.compliant.solution import between_stations
from tipoff.lowfi.contact.springs import outward, pad_point, relative_pose
from tipoff.lowfi.contact.step_limit import inverse_mass
from tipoff.lowfi.contact.wall_ends import CLOSING
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.mechanics.rail_compliance import RailCompliance

MODE = np.dtype(
    [
        ("square", float),  # 1/s2
        ("drag", float),  # 1/s
        ("amplitude", float),  # kg^0.5 m
        ("rate", float),  # kg^0.5 m/s
        ("force", float),  # kg^0.5 m/s2
        ("before", float),  # J, energy as the contact began
    ]
)
# The time (s) of the modes of a rail, and whether a contact is in progress.
RAIL = np.dtype([("time", float), ("pressed", np.bool_)])
# Of the present contact: impulse (N s) and the last speed (m/s) away from the wall.
FACE = np.dtype([("impulse", float), ("leaving", float)])


@by_reference
class Neglected(NamedTuple):
    """All n modes of each of r rails under f faces, and their effect."""

    cubic: np.ndarray  # (s-1, f, n, 4, p) 1/kg^0.5, as in ``record.Modes``
    dragged: np.ndarray  # (s-1, f, n, 4, d) 1/kg^0.5, likewise
    friction: np.ndarray  # (1,) coefficient of the friction that drags the walls
    modes: np.ndarray  # (r, n) of MODE
    rails: np.ndarray  # (r,) of RAIL
    faces: np.ndarray  # (f,) of FACE
    effect: np.ndarray  # (n,) rad/s, of the mode of this number on all rails


def watched(
    found: RailCompliance | None,
    damping: Damping | None,
    pressed: Compliance | None,
    watches: bool,
) -> Neglected | None:
    """Record of the modes of the rail compliance ``found``, whose record is ``pressed``, with the
    ``damping`` of its rails. If no run ``watches`` them, it has no modes, so that the kernels are the same.
    None for rigid walls."""
    if found is None or pressed is None:
        return None
    if not watches:
        none = zeros((0, 0))
        return build(none, none, zeros((0, 0, 0, 0, 0)))
    square, drag = found.frequency**2, drag_of(found.frequency**2, damping)
    along = found.shapes_along if pressed.dragged.size else None
    return build(square, drag, found.shapes, along, pressed.workspace.friction)


def build(
    square: np.ndarray,
    drag: np.ndarray,
    cubic: np.ndarray,
    dragged: np.ndarray | None = None,
    friction: np.ndarray | None = None,
) -> Neglected:
    """Record at rest."""
    at_rest = np.zeros(square.shape, MODE)
    at_rest["square"], at_rest["drag"] = square, drag
    return Neglected(
        cubic=cubic,
        dragged=zeros((0, 0, 0, 0, 0)) if dragged is None else dragged,
        friction=zeros((1,)) if friction is None else friction,
        modes=at_rest,
        rails=np.zeros(square.shape[0], RAIL),
        faces=np.zeros(cubic.shape[1], FACE),
        effect=zeros((square.shape[1],)),
    )


@kernel
def reset(neglected):
    """Bring all rails to rest."""
    for rail in range(neglected.rails.size):
        neglected.rails[rail].time = 0.0
        neglected.rails[rail].pressed = False
        for i in range(neglected.effect.size):
            mode = neglected.modes[rail, i]
            mode.amplitude, mode.rate, mode.force, mode.before = 0.0, 0.0, 0.0, 0.0
    for face in range(neglected.faces.size):
        neglected.faces[face].impulse = 0.0
        neglected.faces[face].leaving = 0.0
    neglected.effect[:] = 0.0


@kernel
def follow(neglected, system, loop):
    """Drive the modes through the last step."""
    compliance, clock = system.compliance, loop.clock
    for rail in range(compliance.members.shape[0]):
        if is_pressed(compliance.members, rail, loop.touching):
            if not neglected.rails[rail].pressed:
                _begin(neglected, compliance.members, rail, clock.began)
            _press(neglected, system, loop, rail)
        elif neglected.rails[rail].pressed:
            _leave(neglected, system, loop.start, rail)


@kernel
def _begin(neglected, members, rail, time):
    """Advance the free modes of a rail to the ``time`` (s) at which a contact begins."""
    record = neglected.rails[rail]
    record.pressed = True
    for i in range(neglected.effect.size):
        mode = neglected.modes[rail, i]
        mode.force = 0.0
        drive(mode, time - record.time, 0.0)
        mode.before = energy(mode)
    record.time = time
    for k in range(members.shape[1]):
        if members[rail, k] >= 0:
            neglected.faces[members[rail, k]].impulse = 0.0


@kernel
def _press(neglected, system, loop, rail):
    compliance, dt = system.compliance, loop.clock.now - neglected.rails[rail].time
    payload, size = system.payload, patterns.count(compliance.workspace.levels)
    body = slot.motion(payload, loop.end, slot.PAYLOAD)
    place, _ = relative_pose(system.platform, body, slot.frame(system.platform, loop.end))
    station, way, _ = between_stations(compliance, place[0] + system.faces[0, 0])
    workspace, pressure = compliance.workspace, compliance.workspace.own
    for i in range(neglected.effect.size):
        total = 0.0
        for k in range(compliance.members.shape[1]):
            face = compliance.members[rail, k]
            if face >= 0 and loop.touching[face]:
                own = workspace.part[face]
                parts.to_part(workspace.levels, own, workspace.force[face], pressure)
                for a in range(size):
                    value, _ = modes.shape(neglected, station, face, i, a, way)
                    total += value * pressure[a]
        drive(neglected.modes[rail, i], dt, total)
    for k in range(compliance.members.shape[1]):
        face = compliance.members[rail, k]
        if face >= 0 and loop.touching[face]:
            neglected.faces[face].impulse += dt * compliance.workspace.force[face, 0]
            neglected.faces[face].leaving = -loop.after[face, CLOSING]
    neglected.rails[rail].time = loop.clock.now


@kernel
def drive(mode, dt, force):
    """Advance one mode by ``dt`` (s) under a force that changes linearly to ``force``; the
    particular solution is linear too."""
    square, drag = mode.square, mode.drag
    slope = (force - mode.force) / dt if dt > 0.0 else 0.0
    lag = drag * slope / square
    q, rate = oscillated(
        square,
        drag,
        dt,
        mode.amplitude - (mode.force - lag) / square,
        mode.rate - slope / square,
    )
    mode.amplitude = q + (force - lag) / square
    mode.rate = rate + slope / square
    mode.force = force


@kernel
def energy(mode):
    """Energy (J) of one mode."""
    return 0.5 * (mode.rate * mode.rate + mode.square * mode.amplitude * mode.amplitude)


@kernel
def _leave(neglected, system, state, rail):
    """End the contact of a rail at ``state`` and add the effect of each mode on the rates."""
    compliance, payload, platform = system.compliance, system.payload, system.platform
    neglected.rails[rail].pressed = False
    number = _most_pressed(compliance.members, neglected.faces, rail)
    face = system.faces[number]
    body = slot.motion(payload, state, slot.PAYLOAD)
    base = slot.frame(platform, state)
    point, n = pad_point(face, body), outward(face, base)
    mass = 1.0 / inverse_mass(platform, payload, body, base, point, n)
    p, speed = body.place, abs(neglected.faces[number].leaving)
    arm = (point[0] - p[0], point[1] - p[1], point[2] - p[2])
    turned = rotation.angular_velocity(body.turn, payload.inverse_inertia, rotation.cross(arm, n))
    by_impulse = np.sqrt(rotation.dot(turned, turned))
    for i in range(neglected.effect.size):
        mode = neglected.modes[rail, i]
        left = np.sqrt(max(0.0, speed * speed - 2.0 * (energy(mode) - mode.before) / mass))
        neglected.effect[i] += by_impulse * mass * abs(speed - left)


@kernel
def _most_pressed(members, faces, rail):
    """The face on ``rail`` with the largest impulse."""
    most = members[rail, 0]
    for k in range(members.shape[1]):
        face = members[rail, k]
        if face >= 0 and faces[face].impulse > faces[most].impulse:
            most = face
    return most
