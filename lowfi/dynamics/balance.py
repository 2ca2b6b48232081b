"""Motion, ledgers and checks of a Trajectory, from samples."""

import math

import numpy as np

from tipoff.lowfi import state
from tipoff.lowfi.dynamics import audit
from tipoff.lowfi.dynamics.loop import Loop
from tipoff.lowfi.dynamics.sample import (
    APART,
    AXIAL_KINETIC,
    GIVEN,
    KINETIC,
    LINEAR,
    RATE,
    STORED,
    STRAIN,
    WORKS,
)
from tipoff.mechanics import ledger, momenta
from tipoff.mechanics.model import Model
from tipoff.mechanics.outcome import Motion
from tipoff.mechanics.promises import Promises

_ENTRY = {name: index for index, name in enumerate(ledger.ENTRIES)}


def motion(rows: np.ndarray, interval: float) -> Motion:
    """Motion of ``rows`` (n, SAMPLE_SIZE), ``interval`` (s) apart from ignition on."""
    parts = [
        rows[:, body + begin : body + begin + size]
        for body in (state.PAYLOAD, state.PLATFORM)
        for begin, size in ((state.PLACE, 3), (state.VELOCITY, 3), (state.QUATERNION, 4), (RATE, 3))
    ]
    return Motion(np.arange(len(rows)) * interval, *parts)


def ledgers(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Total and transverse ledger (n, len(ENTRIES)) J of ``rows`` (n, SAMPLE_SIZE)."""

    def work(slot):
        values = rows[:, WORKS + slot - state.WORK]
        # Pushers count from zero travel, which need not be the travel at ignition.
        return values - values[0] if slot in (state.THRUST, state.THRUST_AXIAL) else values

    total = np.zeros((len(rows), len(ledger.ENTRIES)))
    for name, values in (
        ("thrust", work(state.THRUST)),
        (ledger.BODY_FORCE, work(state.BODY_FORCE)),
        ("kinetic", rows[:, KINETIC]),
        ("strain", rows[:, STRAIN]),
        ("contact_stored", rows[:, STORED]),
        ("contact_damping", work(state.DAMPING)),
        ("friction", work(state.FRICTION)),
        ("released", work(state.RELEASED)),
        ("structural_damping", work(state.STRUCTURAL)),
    ):
        total[:, _ENTRY[name]] = values
    across = total.copy()
    for name, values in (
        ("thrust", work(state.THRUST_AXIAL)),
        (ledger.BODY_FORCE, work(state.BODY_FORCE_AXIAL)),
        ("kinetic", rows[:, AXIAL_KINETIC]),
        ("friction", work(state.FRICTION_AXIAL)),
        ("contact_axial", -work(state.CONTACT_AXIAL)),
    ):
        across[:, _ENTRY[name]] -= values
    return total, across


def checks(
    rows: np.ndarray,
    moved: Motion,
    forces: np.ndarray,
    model: Model,
    loop: Loop,
    promised: Promises,
) -> dict[str, float]:
    """Measured errors of the ``promised`` balances: of the ledgers at the ends of all steps, of the
    momenta at all samples with pad ``forces`` (n,f,3) N."""
    energy, transverse = audit.errors(
        loop.audit, promised.energy_error, promised.transverse_energy_error
    )
    linear, angular = momenta.errors(
        _sums(rows, moved, forces, model), promised, int(loop.counts.steps)
    )
    clock = loop.clock
    norms = [
        np.sqrt(np.einsum("ni,ni->n", q, q)) for q in (moved.quaternion, moved.platform_quaternion)
    ]
    return {
        "energy_error": float(energy),
        "transverse_energy_error": float(transverse),
        "linear_momentum_error": linear,
        "angular_momentum_error": angular,
        "quaternion_error": float(max(np.abs(norm - 1.0).max() for norm in norms)),
        "friction_power_max": _power(clock.friction_power),
        "damping_power_max": _power(clock.damping_power),
    }


def _sums(rows: np.ndarray, moved: Motion, forces: np.ndarray, model: Model) -> momenta.Sums:
    """Momenta and impulses of both bodies, and the sums of the magnitudes of their terms."""
    payload, platform = model.payload, model.platform
    together = 1.0 - rows[:, APART, None]  # afterwards angular momentum is about the mass centres
    places = (together * moved.position, together * moved.platform_position)
    bodies = [(payload.mass, places[0], moved.velocity, moved.rate @ payload.inertia)]
    if platform is not None:
        spin = moved.platform_rate @ platform.inertia
        bodies.append((platform.mass, places[1], moved.platform_velocity, spin))
    given = rows[:, GIVEN : GIVEN + 6]
    weight = sum(mass for mass, *_ in bodies) * math.hypot(*(model.body_force or ()))
    levers = (*momenta.size(model.faces.centre), abs(model.thrust_arm))
    return momenta.Sums(
        values=rows[:, LINEAR : LINEAR + 6],
        given=given,
        sizes=momenta.of_bodies(bodies),
        impulses=momenta.impulses(moved.time, given, forces, weight),
        reach=float(max(momenta.size(place).max() for place in places) + max(levers)),
    )


def _power(value: float) -> float:
    # Not finite if there was no step. Adding zero turns -0.0 into 0.0.
    return float(value) + 0.0 if np.isfinite(value) else 0.0
