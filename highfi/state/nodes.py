"""Passes over the rail nodes: kick and drift. Written without branches, so that they run at memory
speed.

A node without inverse mass is clamped or padding: it has no resistance and stays where it is in the
frame.
"""

import numpy as np

from tipoff.highfi.extruded.mesh import LANES
from tipoff.highfi.state.pose import triple
from tipoff.highfi.state.records import PULL, RATE
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel


@kernel
def kick_nodes(inverse_mass, velocity, resistance, pull, dt):
    """w += dt (pull - r / m) for all nodes; ``pull`` is gravity in frame axes (m/s2)."""
    for i in range(3):
        _kick_component(inverse_mass, velocity.T[i], resistance.T[i], pull[i], dt)


@kernel
def _kick_component(inverse_mass, velocity, resistance, pull, dt):
    for node in range(inverse_mass.size):
        velocity[node] = _kicked(velocity[node], resistance[node], inverse_mass[node], pull, dt)


@kernel
def _kicked(velocity, resistance, inverse_mass, pull, dt):
    return velocity + dt * (pull - inverse_mass * resistance) if inverse_mass > 0.0 else velocity


@kernel
def move_nodes(rail, frame, state, dt, first, last):
    """Kick and drift nodes ``first`` to ``last`` in a frame that moves as ``state.motion`` says;
    see ``pose``."""
    x, u, w, f = rail.points.T, state.displacement.T, state.velocity.T, state.resistance.T
    # Unsigned, because an index that might be negative would keep the loops from being vectorised.
    first, last, pull = np.uint64(first), np.uint64(last), state.motion[PULL:]
    if frame is None:
        for i in range(3):
            _move_component(rail.inverse_mass, u[i], w[i], f[i], pull[i], dt, first, last)
    if frame is not None:
        _move_in_frame(
            x[0],
            x[1],
            x[2],
            rail.inverse_mass,
            u[0],
            u[1],
            u[2],
            w[0],
            w[1],
            w[2],
            f[0],
            f[1],
            f[2],
            state.motion,
            dt,
            first,
            last,
        )


@kernel
def _move_component(inverse_mass, displacement, velocity, resistance, pull, dt, first, last):
    for node in range(first, last):
        velocity[node] = _kicked(velocity[node], resistance[node], inverse_mass[node], pull, dt)
        displacement[node] = (
            displacement[node] + dt * velocity[node] if inverse_mass[node] > 0.0 else 0.0
        )


@kernel
def _move_in_frame(x, y, z, inverse_mass, u, v, w, p, q, r, a, b, c, motion, dt, first, last):
    # Read once: the compiler cannot know that the loop leaves them alone.
    fx, fy, fz, gx, gy, gz = (
        motion[0],
        motion[1],
        motion[2],
        motion[PULL],
        motion[PULL + 1],
        motion[PULL + 2],
    )
    t0, t1, t2, t3, t4, t5, t6, t7, t8 = (
        motion[3],
        motion[4],
        motion[5],
        motion[6],
        motion[7],
        motion[8],
        motion[9],
        motion[10],
        motion[11],
    )
    for node in range(first, last):
        m = inverse_mass[node]
        px, py, pz = (
            _kicked(p[node], a[node], m, gx, dt),
            _kicked(q[node], b[node], m, gy, dt),
            _kicked(r[node], c[node], m, gz, dt),
        )
        dx, dy, dz = u[node] + dt * (px - fx), v[node] + dt * (py - fy), w[node] + dt * (pz - fz)
        ax, ay, az = x[node] + dx, y[node] + dy, z[node] + dz
        u[node] = dx + (t0 * ax + t1 * ay + t2 * az) if m > 0.0 else 0.0
        v[node] = dy + (t3 * ax + t4 * ay + t5 * az) if m > 0.0 else 0.0
        w[node] = dz + (t6 * ax + t7 * ay + t8 * az) if m > 0.0 else 0.0
        p[node] = px + (t0 * px + t1 * py + t2 * pz)
        q[node] = py + (t3 * px + t4 * py + t5 * pz)
        r[node] = pz + (t6 * px + t7 * py + t8 * pz)


@kernel
def turning(displacement, resistance, first, last, lanes, total):
    """Set ``total`` (3,) to the sum of u x r over nodes ``first`` to ``last``, whole vectors of
    them (N m).

    ``lanes`` (3 or more, LANES) is room for sums taken lane by lane, in an order that does not hang
    on who computes them.
    """
    u, f = displacement.T, resistance.T
    lanes[:] = 0.0
    _add_cross(u[0], u[1], u[2], f[0], f[1], f[2], np.uint64(first), np.uint64(last), lanes)
    for i in range(3):
        total[i] = 0.0
        for lane in range(LANES):
            total[i] += lanes[i, lane]


@kernel
def _add_cross(u, v, w, a, b, c, first, last, lanes):
    for start in range(first, last, np.uint64(LANES)):
        for lane in range(np.uint64(LANES)):
            node = start + lane
            lanes[0, lane] += v[node] * c[node] - w[node] * b[node]
            lanes[1, lane] += w[node] * a[node] - u[node] * c[node]
            lanes[2, lane] += u[node] * b[node] - v[node] * a[node]


@kernel
def hold(rail, resistance, first, last, total):
    """Set ``total`` (6,) to force (N) and moment about the frame's origin (N m) of clamped nodes
    ``first`` to ``last``, then their resistance to zero."""
    total[:] = 0.0
    for k in range(first, last):
        node = rail.clamped[k]
        f = triple(resistance[node])
        moment = rotation.cross(triple(rail.points[node]), f)
        for i in range(3):
            total[i] += f[i]
            total[3 + i] += moment[i]
            resistance[node, i] = 0.0


@kernel
def follow_frame(rail, state, frame, nodes, first, last):
    """Give clamped ``nodes`` from number ``first`` to ``last`` the frame's own inertial velocity,
    which friction needs."""
    if frame is not None:
        velocity, rate = (
            triple(state.motion),
            (state.motion[RATE], state.motion[RATE + 1], state.motion[RATE + 2]),
        )
        for k in range(first, last):
            node = nodes[k]
            spin = rotation.cross(
                rate, (rail.points[node, 0], rail.points[node, 1], rail.points[node, 2])
            )
            for i in range(3):
                state.velocity[node, i] = velocity[i] + spin[i]
