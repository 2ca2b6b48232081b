"""Largest load of each guide of the reference (``mechanics.books``), from the forces at each step."""

from tipoff.highfi.state.pose import triple
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics import books


@inlined
def begin_loads(constants, state):
    """Begin with the loads at ignition."""
    state.guide_loads[:] = 0.0
    follow_loads(constants, state, 0.0)


@inlined
def follow_loads(constants, state, time):
    """Raise the largest loads to those of the present forces, at ``time`` (s)."""
    if state.load[0].pressed > 0:
        _take(constants.faces.guide, constants.frame, state, time)


@kernel
def _take(guide, frame, state, time):
    """Forces are in the axes of the frame; those of a fixed frame are the scene axes."""
    loads, turn = state.guide_loads, _turn(frame, state)
    body = rotation.matrix(_four(state.payload.quaternion))
    books.clear_loads(loads)
    for face in range(guide.size):
        force, moment = triple(state.face_force[face]), triple(state.face_moment[face])
        if force[0] != 0.0 or force[1] != 0.0 or force[2] != 0.0:
            own = rotation.unrotate(body, rotation.rotate(turn, force))
            couple = rotation.unrotate(body, rotation.rotate(turn, moment))
            books.add_load(loads, guide[face], own, couple)
    books.take_loads(loads, time)


@kernel
def _turn(frame, state):
    if frame.free:
        return rotation.matrix(_four(state.platform.quaternion))
    return (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@kernel
def _four(q):
    return (q[0], q[1], q[2], q[3])
