"""The hold-down of the reference (``scenes.effects.hold_down``): an impulse after each kick by which
the payload's speed along the rail, relative to the platform, stays zero.

The kick of step n is held if its time is before the release. So the impulse until the release is
exact to half a step.
"""

from tipoff.highfi.dynamics.pushers import Arm, kick_pair, mobility, present_speed
from tipoff.highfi.state.records import AXIAL, HOLD_DOWN, TOTAL
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel


@inlined
def hold(latch, constants, state, pose, time, dt):
    """Hold the payload at the end of the kick of ``time`` (s) over ``dt`` (s)."""
    state.holding[0] = 0.0
    if time < latch.release:
        state.evaluated[HOLD_DOWN] += 1
        arm = _arm(latch, constants.frame, state, pose)
        speed = present_speed(constants, state, arm)
        size = -speed / mobility(constants, state, arm, arm)
        kick_pair(constants, state, arm, size)
        state.holding[0] = size / dt


@kernel
def _arm(latch, frame, state, pose):
    """The line of the latch, beside the payload's mass centre."""
    aside = (0.0, latch.line[0] - pose.centre[1], latch.line[1] - pose.centre[2])
    out = rotation.rotate(pose.frame, aside)
    return Arm(rotation.rotate(pose.frame, (1.0, 0.0, 0.0)), out, _on_platform(frame, state, out))


@kernel
def _on_platform(frame, state, out):
    if frame.free:
        p, b = state.payload.position, state.platform.position
        return (out[0] + p[0] - b[0], out[1] + p[1] - b[1], out[2] + p[2] - b[2])
    return out


@inlined
def work_of_hold_down(latch, constants, state, pose, axial_speed, half):
    """Add the work of the last force over ``half`` a step (s). ``axial_speed`` (m/s) as in
    ``pushers.work_of_pushers``."""
    arm, force = _arm(latch, constants.frame, state, pose), half * state.holding[0]
    state.work[TOTAL].thrust += force * present_speed(constants, state, arm)
    state.work[AXIAL].thrust += force * arm.direction[0] * axial_speed
