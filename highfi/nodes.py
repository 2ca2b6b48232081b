"""Passes over the rail nodes: kick, drift, gravity. Written without branches, so that they run at memory speed.

Clamped nodes have no inverse mass and no resistance; whatever the drift does to them is put right by ``hold_clamped``.
"""

from highfi.pose import triple
from scenes import rotation
from scenes.jit import njit


@njit
def kick_nodes(points, inverse_mass, displacement, velocity, resistance, dt):
    """w -= dt r / m. Returns sum and moment about the frame's origin of the forces -r on the moving nodes (N, N m)."""
    fx, fy, fz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for node in range(inverse_mass.size):
        scale = dt * inverse_mass[node]
        a, b, c = -resistance[node, 0], -resistance[node, 1], -resistance[node, 2]
        x = points[node, 0] + displacement[node, 0]
        y = points[node, 1] + displacement[node, 1]
        z = points[node, 2] + displacement[node, 2]
        fx += a
        fy += b
        fz += c
        mx += y * c - z * b
        my += z * a - x * c
        mz += x * b - y * a
        velocity[node, 0] += scale * a
        velocity[node, 1] += scale * b
        velocity[node, 2] += scale * c
    return (fx, fy, fz), (mx, my, mz)


@njit
def drift_nodes(displacement, velocity, dt):
    """u += dt w, in a frame that rests."""
    for node in range(displacement.shape[0]):
        displacement[node, 0] += dt * velocity[node, 0]
        displacement[node, 1] += dt * velocity[node, 1]
        displacement[node, 2] += dt * velocity[node, 2]


@njit
def drift_nodes_in_frame(points, displacement, velocity, frame_velocity, turn, dt):
    """Drift seen from a frame that moves at ``frame_velocity`` (m/s) and turns by 1 + ``turn``; see ``pose``."""
    q0, q1, q2, q3, q4, q5, q6, q7, q8 = turn
    vx, vy, vz = frame_velocity
    for node in range(displacement.shape[0]):
        wx, wy, wz = velocity[node, 0], velocity[node, 1], velocity[node, 2]
        a = displacement[node, 0] + dt * (wx - vx)
        b = displacement[node, 1] + dt * (wy - vy)
        c = displacement[node, 2] + dt * (wz - vz)
        x, y, z = points[node, 0] + a, points[node, 1] + b, points[node, 2] + c
        displacement[node, 0] = a + (q0 * x + q1 * y + q2 * z)
        displacement[node, 1] = b + (q3 * x + q4 * y + q5 * z)
        displacement[node, 2] = c + (q6 * x + q7 * y + q8 * z)
        velocity[node, 0] = wx + (q0 * wx + q1 * wy + q2 * wz)
        velocity[node, 1] = wy + (q3 * wx + q4 * wy + q5 * wz)
        velocity[node, 2] = wz + (q6 * wx + q7 * wy + q8 * wz)


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
