"""One sample of a run: places, velocities, rates, energies and momenta of a state, and the force on every pad face."""

from lowfi import state as slot
from lowfi.events import stored
from lowfi.state import IMPULSE, MOMENT, PAYLOAD, PLATFORM, VELOCITY, WORK, WORK_SIZE
from lowfi.touch import load, penetration, relative_pose
from scenes import rotation
from scenes.jit import njit

# Slots of a sample: payload and platform first (place, velocity, quaternion, rate in body axes), each BODY_SIZE long.
RATE = slot.MOMENT  # where the state holds angular momentum the sample holds the rate
KINETIC, AXIAL_KINETIC, STORED, WORKS = 26, 27, 28, 29
LINEAR, ANGULAR, GIVEN = WORKS + WORK_SIZE, WORKS + WORK_SIZE + 3, WORKS + WORK_SIZE + 6
SAMPLE_SIZE = GIVEN + 6


@njit
def observe(model, engaged, state, row, forces):
    """Fill ``row`` (SAMPLE_SIZE,) and ``forces`` (f,3) N on the payload in scene axes."""
    payload = model.payload
    body, base = slot.motion(payload.mass, payload.inverse_inertia, state, PAYLOAD), slot.frame(model.platform, state)
    row[:] = 0.0
    _copy(state, PAYLOAD, body, row)
    _copy(state, PLATFORM, base, row)
    _body(payload.mass, state, PAYLOAD, body, row)
    _platform(model.platform, state, base, row)
    row[STORED] = _press(model.contact, model.friction, model.faces, model.platform, engaged, body, base, forces)
    row[WORKS:WORKS + WORK_SIZE] = state[WORK:WORK + WORK_SIZE]
    row[GIVEN:GIVEN + 6] = state[IMPULSE:IMPULSE + 6]


@njit
def _copy(state, which, body, row):
    row[which:which + slot.MOMENT] = state[which:which + slot.MOMENT]
    rate = rotation.unrotate(body.turn, body.rate)
    for i in range(3):
        row[which + RATE + i] = rate[i]


@njit
def _platform(platform, state, base, row):
    if platform is not None:
        _body(platform.mass, state, PLATFORM, base, row)


@njit
def _body(mass, state, which, body, row):
    """Add kinetic energy and momenta of one body."""
    moment, orbit = slot.triple(state, which + MOMENT), rotation.cross(body.place, body.velocity)
    spin = (moment[0] - mass * orbit[0], moment[1] - mass * orbit[1], moment[2] - mass * orbit[2])
    row[KINETIC] += 0.5 * (mass * rotation.dot(body.velocity, body.velocity) + rotation.dot(spin, body.rate))
    row[AXIAL_KINETIC] += 0.5 * mass * body.velocity[0] * body.velocity[0]
    for i in range(3):
        row[LINEAR + i] += mass * state[which + VELOCITY + i]
        row[ANGULAR + i] += moment[i]


@njit
def _press(laws, friction, faces, platform, engaged, body, base, forces):
    """Fill ``forces``; the energy (J) stored in all faces."""
    energy = 0.0
    forces[:] = 0.0
    if laws is not None:
        place, turn = relative_pose(platform, body, base)
        for i in range(engaged.size):
            if engaged[i]:
                p = penetration(faces, i, place, turn)
                if p > 0.0:
                    face = load(laws, friction, faces, platform, i, p, body, base)
                    energy += stored(laws, p)
                    for j in range(3):
                        forces[i, j] = face.normal[j] + face.drag[j]
    return energy
