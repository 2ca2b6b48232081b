"""Passes over the rail nodes: kick, drift, gravity. Written without branches, so that they run at memory speed.

Clamped nodes have no inverse mass and no resistance; whatever the drift does to them is put right by ``hold_clamped``.
"""

from highfi.pose import triple
from scenes import rotation
from scenes.jit import njit


@njit
def kick_nodes(points, inverse_mass, displacement, velocity, resistance, dt):
    """w -= dt r / m. Returns sum and moment about the frame's origin of the forces -r on the moving nodes (N, N m)."""
    x, u, r = points.T, displacement.T, resistance.T
    for i in range(3):
        _kick_component(inverse_mass, velocity.T[i], r[i], dt)
    return _sums(x[0], x[1], x[2], u[0], u[1], u[2], r[0], r[1], r[2])


@njit
def _kick_component(inverse_mass, velocity, resistance, dt):
    for node in range(inverse_mass.size):
        velocity[node] -= dt * inverse_mass[node] * resistance[node]


@njit
def _sums(x, y, z, u, v, w, a, b, c):
    """Sum of -(a, b, c) and of its moment at (x + u, y + v, z + w)."""
    fx, fy, fz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for node in range(x.size):
        px, py, pz = x[node] + u[node], y[node] + v[node], z[node] + w[node]
        fx -= a[node]
        fy -= b[node]
        fz -= c[node]
        mx += pz * b[node] - py * c[node]
        my += px * c[node] - pz * a[node]
        mz += py * a[node] - px * b[node]
    return (fx, fy, fz), (mx, my, mz)


@njit
def drift_nodes(displacement, velocity, dt):
    """u += dt w, in a frame that rests."""
    for i in range(3):
        _drift_component(displacement.T[i], velocity.T[i], dt)


@njit
def _drift_component(displacement, velocity, dt):
    for node in range(displacement.size):
        displacement[node] += dt * velocity[node]


@njit
def drift_nodes_in_frame(points, displacement, velocity, frame_velocity, turn, dt):
    """Drift seen from a frame that moves at ``frame_velocity`` (m/s) and turns by 1 + ``turn``; see ``pose``."""
    x, u, w = points.T, displacement.T, velocity.T
    _drift_and_turn(x[0], x[1], x[2], u[0], u[1], u[2], w[0], w[1], w[2], frame_velocity, turn, dt)


@njit
def _drift_and_turn(x, y, z, u, v, w, p, q, r, frame_velocity, turn, dt):
    t0, t1, t2, t3, t4, t5, t6, t7, t8 = turn
    fx, fy, fz = frame_velocity
    for node in range(x.size):
        px, py, pz = p[node], q[node], r[node]
        a, b, c = u[node] + dt * (px - fx), v[node] + dt * (py - fy), w[node] + dt * (pz - fz)
        ax, ay, az = x[node] + a, y[node] + b, z[node] + c
        u[node] = a + (t0 * ax + t1 * ay + t2 * az)
        v[node] = b + (t3 * ax + t4 * ay + t5 * az)
        w[node] = c + (t6 * ax + t7 * ay + t8 * az)
        p[node] = px + (t0 * px + t1 * py + t2 * pz)
        q[node] = py + (t3 * px + t4 * py + t5 * pz)
        r[node] = pz + (t6 * px + t7 * py + t8 * pz)


@njit
def hold_clamped(rail, state, velocity, rate):
    """Clamped nodes do not move in the frame; their inertial velocity is the frame's own, which friction needs."""
    for node in rail.clamped:
        spin = rotation.cross(rate, (rail.points[node, 0], rail.points[node, 1], rail.points[node, 2]))
        for i in range(3):
            state.displacement[node, i] = 0.0
            state.velocity[node, i] = velocity[i] + spin[i]


@njit
def weigh_nodes(rail, gravity, state, pose, dt):
    """Gravity on the moving nodes; returns their mass (kg) and mass centre in inertial axes (m) for the momentum check."""
    mass, x, y, z = 0.0, 0.0, 0.0, 0.0
    if gravity is not None:
        g = rotation.unrotate(pose.frame, (gravity.x, gravity.y, gravity.z))
        for node in range(rail.mass.size):
            if rail.inverse_mass[node] > 0.0:
                m = rail.mass[node]
                mass += m
                x += m * (rail.points[node, 0] + state.displacement[node, 0])
                y += m * (rail.points[node, 1] + state.displacement[node, 1])
                z += m * (rail.points[node, 2] + state.displacement[node, 2])
                for i in range(3):
                    state.velocity[node, i] += dt * g[i]
        for i in range(3):
            state.rail_momentum[i] += dt * mass * g[i]
    place = (0.0, 0.0, 0.0)
    if mass > 0.0:
        place = rotation.rotate(pose.frame, (x / mass, y / mass, z / mass))
    p = state.platform.position
    return mass, (p[0] + place[0], p[1] + place[1], p[2] + place[2])
