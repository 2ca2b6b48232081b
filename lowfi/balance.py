"""From samples to the motion a Trajectory holds, its ledgers and its checks."""

import numpy as np

from lowfi import state
from lowfi.march import DAMPING_POWER, FRICTION_POWER
from lowfi.sample import ANGULAR, AXIAL_KINETIC, GIVEN, KINETIC, LINEAR, RATE, STORED, STRAIN, WORKS
from scenes import ledger, rotation
from scenes.outcome import Motion

_ENTRY = {name: index for index, name in enumerate(ledger.ENTRIES)}


def motion(rows: np.ndarray, interval: float) -> Motion:
    """Motion of ``rows`` (n, SAMPLE_SIZE), ``interval`` (s) apart from ignition on."""
    parts = [rows[:, body + begin:body + begin + size] for body in (state.PAYLOAD, state.PLATFORM)
             for begin, size in ((state.PLACE, 3), (state.VELOCITY, 3), (state.QUATERNION, 4), (RATE, 3))]
    return Motion(np.arange(len(rows)) * interval, *parts)


def ledgers(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Total and transverse ledger (n, len(ENTRIES)) J of ``rows`` (n, SAMPLE_SIZE)."""
    def work(slot):
        return rows[:, WORKS + slot - state.WORK]

    total = np.zeros((len(rows), len(ledger.ENTRIES)))
    for name, values in (("thrust", work(state.THRUST)), ("gravity", work(state.GRAVITY)), ("kinetic", rows[:, KINETIC]),
                         ("strain", rows[:, STRAIN]), ("contact_stored", rows[:, STORED]), ("contact_damping", work(state.DAMPING)),
                         ("friction", work(state.FRICTION)), ("released", work(state.RELEASED)),
                         ("structural_damping", work(state.STRUCTURAL))):
        total[:, _ENTRY[name]] = values
    across = total.copy()
    for name, values in (("thrust", work(state.THRUST_AXIAL)), ("gravity", work(state.GRAVITY_AXIAL)),
                         ("kinetic", rows[:, AXIAL_KINETIC]), ("friction", work(state.FRICTION_AXIAL)),
                         ("contact_axial", -work(state.CONTACT_AXIAL))):
        across[:, _ENTRY[name]] -= values
    return total, across


def checks(rows: np.ndarray, moved: Motion, total: np.ndarray, across: np.ndarray, mass: float,
           clock: np.ndarray) -> dict[str, float]:
    """The kept promises. Momentum errors are relative to the largest momentum, of the payload or of the whole, in the run."""
    own = mass * moved.velocity
    norms = [np.sqrt(np.einsum("ni,ni->n", q, q)) for q in (moved.quaternion, moved.platform_quaternion)]
    return {"energy_error": ledger.total_error(total), "transverse_energy_error": ledger.transverse_error(across),
            "linear_momentum_error": _unexplained(rows, LINEAR, GIVEN, own),
            "angular_momentum_error": _unexplained(rows, ANGULAR, GIVEN + 3, rotation.crosses(moved.position, own)),
            "quaternion_error": float(max(np.abs(norm - 1.0).max() for norm in norms)),
            "friction_power_max": _power(clock[FRICTION_POWER]), "damping_power_max": _power(clock[DAMPING_POWER])}


def _power(value: float) -> float:
    # A run without a single step has felt no power at all. Adding zero turns -0.0 into 0.0.
    return float(value) + 0.0 if np.isfinite(value) else 0.0


def _unexplained(rows: np.ndarray, momentum: int, impulse: int, own: np.ndarray) -> float:
    """Largest change of a momentum that no impulse from outside explains, over the largest momentum."""
    values = rows[:, momentum:momentum + 3]
    lost = values - values[0] - (rows[:, impulse:impulse + 3] - rows[0, impulse:impulse + 3])
    size, scale = _largest(lost), max(_largest(own), _largest(values))
    return size / scale if scale > 0.0 else size


def _largest(values: np.ndarray) -> float:
    return float(np.sqrt(np.einsum("ni,ni->n", values, values).max()))
