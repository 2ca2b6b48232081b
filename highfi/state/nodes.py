"""Loops over the rail nodes: kick, drift, sums. They have no branches, so that they run at memory
speed.

A node with zero inverse mass is clamped or padding: it has no resistance and keeps its place in the
frame.
"""

import numpy as np

from tipoff.highfi.extruded.mesh import LANES
from tipoff.highfi.state.pose import less, triple
from tipoff.kernels import rotation
from tipoff.kernels.jit import entry, kernel


@entry
def kick_nodes(inverse_mass, velocity, resistance, acceleration, dt):
    """w += dt (acceleration - r / m) for all nodes; ``acceleration`` (m/s2): body force, frame
    axes."""
    for i in range(3):
        _kick_component(inverse_mass, velocity.T[i], resistance.T[i], acceleration[i], dt)


@kernel
def _kick_component(inverse_mass, velocity, resistance, acceleration, dt):
    for node in range(inverse_mass.size):
        velocity[node] = kicked(
            velocity[node], resistance[node], inverse_mass[node], acceleration, dt
        )


@kernel
def kicked(velocity, resistance, inverse_mass, acceleration, dt):
    """One component of the velocity of a node after a kick."""
    return (
        velocity + dt * (acceleration - inverse_mass * resistance)
        if inverse_mass > 0.0
        else velocity
    )


@kernel
def move_nodes(rail, frame, state, dt, first, last):
    """Kick and drift nodes ``first`` to ``last`` in a frame with the motion ``state.motion``; see
    ``pose``."""
    # Unsigned, because signed indices would prevent vectorisation of the loops.
    first, last = np.uint64(first), np.uint64(last)
    if frame.free:
        _move_in_frame(rail, state, triple(frame.centre), dt, first, last)
    else:
        for i in range(3):
            _move_component(rail, state, i, dt, first, last)


@kernel
def _move_component(rail, state, i, dt, first, last):
    inverse_mass, acceleration = rail.inverse_mass, state.motion.acceleration[i]
    u, w, f = state.displacement.T[i], state.velocity.T[i], state.resistance.T[i]
    for node in range(first, last):
        w[node] = kicked(w[node], f[node], inverse_mass[node], acceleration, dt)
        u[node] = u[node] + dt * w[node] if inverse_mass[node] > 0.0 else 0.0


@kernel
def _move_in_frame(rail, state, centre, dt, first, last):
    inverse_mass, motion = rail.inverse_mass, state.motion
    x, y, z = rail.points.T[0], rail.points.T[1], rail.points.T[2]
    u, v, w = state.displacement.T[0], state.displacement.T[1], state.displacement.T[2]
    p, q, r = state.velocity.T[0], state.velocity.T[1], state.velocity.T[2]
    a, b, c = state.resistance.T[0], state.resistance.T[1], state.resistance.T[2]
    # Read once: the compiler cannot know that the loop does not change them.
    ox, oy, oz = centre
    fx, fy, fz = triple(motion.velocity)
    gx, gy, gz = triple(motion.acceleration)
    t0, t1, t2 = triple(motion.turn)
    t3, t4, t5 = triple(motion.turn[3:])
    t6, t7, t8 = triple(motion.turn[6:])
    for node in range(first, last):
        m = inverse_mass[node]
        px, py, pz = (
            kicked(p[node], a[node], m, gx, dt),
            kicked(q[node], b[node], m, gy, dt),
            kicked(r[node], c[node], m, gz, dt),
        )
        dx, dy, dz = u[node] + dt * (px - fx), v[node] + dt * (py - fy), w[node] + dt * (pz - fz)
        ax, ay, az = x[node] - ox + dx, y[node] - oy + dy, z[node] - oz + dz
        u[node] = dx + (t0 * ax + t1 * ay + t2 * az) if m > 0.0 else 0.0
        v[node] = dy + (t3 * ax + t4 * ay + t5 * az) if m > 0.0 else 0.0
        w[node] = dz + (t6 * ax + t7 * ay + t8 * az) if m > 0.0 else 0.0
        p[node] = px + (t0 * px + t1 * py + t2 * pz)
        q[node] = py + (t3 * px + t4 * py + t5 * pz)
        r[node] = pz + (t6 * px + t7 * py + t8 * pz)


@kernel
def sum_turning(displacement, resistance, first, last, lanes, total):
    """Set ``total`` (3,) to the sum of u x r (N m) over nodes ``first`` to ``last``, in whole
    vectors.

    ``lanes`` (3 or more, LANES) is workspace for sums lane by lane; their order does not depend on
    the number of threads.
    """
    first, last = np.uint64(first), np.uint64(last)
    u, v, w = displacement.T[0], displacement.T[1], displacement.T[2]
    a, b, c = resistance.T[0], resistance.T[1], resistance.T[2]
    lanes[:] = 0.0
    for start in range(first, last, np.uint64(LANES)):
        for lane in range(np.uint64(LANES)):
            node = start + lane
            lanes[0, lane] += v[node] * c[node] - w[node] * b[node]
            lanes[1, lane] += w[node] * a[node] - u[node] * c[node]
            lanes[2, lane] += u[node] * b[node] - v[node] * a[node]
    for i in range(3):
        total[i] = 0.0
        for lane in range(LANES):
            total[i] += lanes[i, lane]


@kernel
def hold(rail, resistance, first, last, total):
    """Set ``total`` (6,) to the force (N) and the moment (N m) about the frame's origin of clamped
    nodes ``first`` to ``last``, then their resistance to zero."""
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
    """Set the velocity of clamped ``nodes`` from number ``first`` to ``last`` to the frame's
    inertial velocity, which friction needs."""
    if frame.free:
        velocity, rate = triple(state.motion.velocity), triple(state.motion.rate)
        for k in range(first, last):
            node = nodes[k]
            spin = rotation.cross(rate, less(triple(rail.points[node]), frame.centre))
            for i in range(3):
                state.velocity[node, i] = velocity[i] + spin[i]
