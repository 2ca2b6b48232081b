"""The cases of one call of the time loop: the inputs that differ between them, and their results.

A run with curves is one case with samples. Cases of an ensemble have none. Their results equal
those of ``lowfi.run``, bit for bit, or are missing: a case that fails, or whose pads press at
ignition, needs a message too, and is left to ``lowfi.run``.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.system import Body, System
from tipoff.mechanics.ending import BOOK_SIZE
from tipoff.scenes.effects.friction import Friction
from tipoff.scenes.effects.sticking import Sticking
from tipoff.scenes.effects.thrust_offset import ThrustOffset

# Columns of the results: whether the case is left to ``lowfi.run``, steps, the book.
LEFT_OPEN, STEPS, BOOK = range(3)
RESULT_SIZE = BOOK + BOOK_SIZE


class Cases(NamedTuple):
    """Inputs that differ between n cases of f faces, and their results."""

    mass: np.ndarray  # (n,) kg, of the payload
    inertia: np.ndarray  # (n, 3, 3) kg m2, of the payload
    inverse_inertia: np.ndarray  # (n, 3, 3) 1/(kg m2), of the payload
    faces: np.ndarray  # (n, f, FACE_SIZE)
    friction: np.ndarray  # (n, 2) static and dynamic coefficient of either law; zero without
    direction: np.ndarray | None  # (n, 3) of the thrust; None without thrust offset
    arm: np.ndarray | None  # (n, 3) m, of the thrust; None without thrust offset
    start: np.ndarray  # (n, STATE_SIZE) state at ignition
    reach: np.ndarray  # (n,) m, as in ``Tolerance``
    results: np.ndarray  # (n, RESULT_SIZE) filled without samples


def alone(system: System, start: np.ndarray, reach: float) -> Cases:
    """``system`` as the only case."""
    offset = system.thrust_offset
    return Cases(
        mass=np.array([system.payload.mass]),
        inertia=system.payload.inertia[None],
        inverse_inertia=system.payload.inverse_inertia[None],
        faces=system.faces[None],
        friction=np.array([coefficients(system.friction or system.sticking)]),
        direction=None if offset is None else np.array([offset.direction]),
        arm=None if offset is None else np.array([offset.arm]),
        start=start[None],
        reach=np.array([reach]),
        results=np.zeros((1, RESULT_SIZE)),
    )


def coefficients(friction: Friction | Sticking | None) -> tuple[float, float]:
    """Static and dynamic coefficient of either law; zero without friction."""
    return (0.0, 0.0) if friction is None else (friction.static, friction.dynamic)


@kernel
def system_of(common, cases, n):
    """The ``common`` system with the inputs of case ``n``."""
    return System(
        payload=Body(cases.mass[n], cases.inertia[n], cases.inverse_inertia[n]),
        platform=common.platform,
        faces=cases.faces[n],
        rail_start=common.rail_start,
        rail_end=common.rail_end,
        thrust=common.thrust,
        reacts_on_platform=common.reacts_on_platform,
        thrust_offset=_offset(cases.direction, cases.arm, n),
        contact=common.contact,
        compliance=common.compliance,
        has_contact=common.has_contact,
        is_compliant=common.is_compliant,
        friction=_friction(common.friction, cases.friction, n),
        sticking=_sticking(common.sticking, cases.friction, n),
        body_force=common.body_force,
        ledger=common.ledger,
        neglected=common.neglected,
    )


@kernel
def _offset(direction, arm, n):
    if direction is not None:
        return ThrustOffset(
            (direction[n, 0], direction[n, 1], direction[n, 2]), (arm[n, 0], arm[n, 1], arm[n, 2])
        )
    return None


@kernel
def _friction(law, coefficient, n):
    if law is not None:
        return Friction(coefficient[n, 0], coefficient[n, 1], law.static_speed, law.dynamic_speed)
    return None


@kernel
def _sticking(law, coefficient, n):
    if law is not None:
        return Sticking(
            coefficient[n, 0], coefficient[n, 1], law.stiffness, law.damping, law.capture_speed
        )
    return None
