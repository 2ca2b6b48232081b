"""The cases of one call of the time loop: the inputs that differ between them, and their results.

A run with curves is one case with samples. Cases of an ensemble have none. Their results equal
those of ``lowfi.run``, bit for bit, or are missing: a case that fails, or whose pads press at
ignition, needs a message too, and is left to ``lowfi.run``.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi import state
from tipoff.lowfi.faces import CENTRE, WALL
from tipoff.lowfi.system import Body, Contact, System
from tipoff.mechanics.absent import NO_LATCH, Offset, offset, rubs
from tipoff.mechanics.books import BOOK_SIZE
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.sticking import Sticking
from tipoff.mechanics.model import Model

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
    direction: np.ndarray  # (n, 3) of the thrust
    arm: np.ndarray  # (n, 3) m, of the thrust
    release: np.ndarray  # (n,) s, of the payload from its latch or stop; -infinity without
    start: np.ndarray  # (n, STATE_SIZE) state at ignition
    reach: np.ndarray  # (n,) m, as in ``Tolerance``
    results: np.ndarray  # (n, RESULT_SIZE) filled without samples


def of_models(system: System, models: Sequence[Model]) -> Cases:
    """A case of each of ``models``, with the faces of ``system`` at their centres and walls."""
    count, centre = len(models), np.array([model.faces.centre for model in models])
    faces = np.repeat(system.faces[None], count, axis=0)
    faces[:, :, CENTRE : CENTRE + 3] = centre
    faces[:, :, WALL] = np.array([model.faces.sign * model.faces.wall for model in models])
    offsets = [offset(model.thrust_offset) for model in models]  # all have one, or none
    latches = [model.hold_down or NO_LATCH for model in models]
    return Cases(
        mass=np.array([model.payload.mass for model in models]),
        inertia=np.array([model.payload.inertia for model in models]),
        inverse_inertia=np.array([model.payload.inverse_inertia for model in models]),
        faces=faces,
        friction=np.array([coefficients(model.friction) for model in models]),
        direction=np.array([each.direction for each in offsets]),
        arm=np.array([each.arm for each in offsets]),
        release=np.array([latch.release for latch in latches]),
        start=np.array([state.initial(model) for model in models]),
        reach=np.sqrt((centre**2).sum(axis=2).max(axis=1)),
        results=np.zeros((count, RESULT_SIZE)),
    )


def coefficients(friction: Friction | Sticking | None) -> tuple[float, float]:
    """Static and dynamic coefficient of either law; zero without friction."""
    return (0.0, 0.0) if friction is None else (friction.static, friction.dynamic)


@kernel
def system_of(common, cases, n):
    """The ``common`` system with the inputs of case ``n``."""
    return System(
        payload=Body(cases.mass[n], cases.inertia[n], cases.inverse_inertia[n], free=True),
        platform=common.platform,
        faces=cases.faces[n],
        rail_start=common.rail_start,
        rail_end=common.rail_end,
        thrust=common.thrust,
        pushing=common.pushing,
        reacts_on_platform=common.reacts_on_platform,
        hold_down=_latch(common.hold_down, cases.release, n),
        thrust_offset=_offset(common.thrust_offset, cases.direction, cases.arm, n),
        contact=_contact(common.contact, cases.friction, n),
        compliance=common.compliance,
        has_contact=common.has_contact,
        is_compliant=common.is_compliant,
        friction=_friction(common.friction, cases.friction, n),
        body_force=common.body_force,
        evaluated=common.evaluated,
        neglected=common.neglected,
    )


@kernel
def _offset(common, direction, arm, n):
    return Offset(
        common.acts,
        (direction[n, 0], direction[n, 1], direction[n, 2]),
        (arm[n, 0], arm[n, 1], arm[n, 2]),
    )


@kernel
def _latch(latch, release, n):
    return HoldDown(release[n], latch.line, latch.is_stop)


@kernel
def _friction(law, coefficient, n):
    share = 1.0 if rubs(law) else 0.0
    return Friction(
        share * coefficient[n, 0], share * coefficient[n, 1], law.static_speed, law.dynamic_speed
    )


@kernel
def _contact(common, coefficient, n):
    if common is not None:
        law = common.sticking
        sticking = Sticking(
            coefficient[n, 0], coefficient[n, 1], law.stiffness, law.damping, law.capture_speed
        )
        return Contact(common.law, common.thermal_offset, sticking)
    return None
