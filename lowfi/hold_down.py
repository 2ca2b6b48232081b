"""The force of the hold-down (``scenes.effects.hold_down``): a pair along the rail that keeps the
payload's speed along the rail, relative to the platform, as it is."""

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.step_limit import mobility
from tipoff.lowfi.pusher_inertia import acceleration, accelerations, of_platform
from tipoff.lowfi.pushers import slip_at


@kernel
def hold(latch, payload, bodies, state, out):
    """Force (N) on the payload and its point (m), with all other forces in ``out``."""
    body, base = bodies.payload, bodies.base
    along = rotation.rotate(base.turn, (1.0, 0.0, 0.0))
    point = _point(latch, body, base)
    there = acceleration(body, accelerations(payload, state, slot.PAYLOAD, body, out), point)
    here = acceleration(base, of_platform(bodies.platform, state, base, out), point)
    turning = rotation.cross(base.rate, slip_at(body, base, point))
    relative = (
        there[0] - here[0] - 2.0 * turning[0],
        there[1] - here[1] - 2.0 * turning[1],
        there[2] - here[2] - 2.0 * turning[2],
    )
    across = mobility(bodies.platform, payload, body, base, (along, point), (along, point))
    size = -rotation.dot(along, relative) / across
    return (size * along[0], size * along[1], size * along[2]), point


@kernel
def _point(latch, body, base):
    """Point (m) of the line of the latch beside the payload's mass centre, in scene axes."""
    b = base.place
    seen = rotation.unrotate(
        base.turn, (body.place[0] - b[0], body.place[1] - b[1], body.place[2] - b[2])
    )
    arm = rotation.rotate(base.turn, (seen[0], latch.line[0], latch.line[1]))
    return (b[0] + arm[0], b[1] + arm[1], b[2] + arm[2])
