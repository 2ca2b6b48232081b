"""From sample vectors to ledgers, momentum checks and the motion a Trajectory holds."""

import numpy as np

from tipoff.highfi.dynamics import observe
from tipoff.highfi.state import records
from tipoff.kernels import rotation
from tipoff.mechanics import ledger, momenta
from tipoff.mechanics.outcome import Motion
from tipoff.mechanics.promises import FINITE_ELEMENTS


def motion(samples: np.ndarray, interval: float, body_offset: np.ndarray) -> Motion:
    """Motion of samples (n, SAMPLE_SIZE); ``body_offset`` (3,) m from the frame's origin to the
    platform's mass centre."""

    def part(first, size=3):
        return samples[:, first : first + size].copy()

    frame = rotation.matrices(part(observe.PLATFORM_QUATERNION, 4))
    offset = frame @ body_offset
    spin = np.einsum("nij,nj->ni", frame, part(observe.PLATFORM_RATE))
    return Motion(
        np.arange(len(samples)) * interval,
        part(observe.POSITION),
        part(observe.VELOCITY),
        part(observe.QUATERNION, 4),
        part(observe.RATE),
        part(observe.PLATFORM_POSITION) + offset,
        part(observe.PLATFORM_VELOCITY) + np.cross(spin, offset),
        part(observe.PLATFORM_QUATERNION, 4),
        part(observe.PLATFORM_RATE),
    )


def ledgers(samples: np.ndarray, work: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Total and transverse ledger (n, len(ENTRIES)) J of samples and accumulated work (n,
    WORK_SIZE)."""
    zero = np.zeros(len(samples))
    kinetic, axial = samples[:, observe.KINETIC], samples[:, observe.AXIAL_KINETIC]
    strain, stored = samples[:, observe.STRAIN], samples[:, observe.CONTACT]
    w = {
        name: work[:, getattr(records, name)]
        for name in (
            "THRUST",
            "GRAVITY",
            "FRICTION",
            "STRUCTURAL_DAMPING",
            "RELEASED",
            "THRUST_AXIAL",
            "GRAVITY_AXIAL",
            "FRICTION_AXIAL",
            "CONTACT_AXIAL",
        )
    }
    total = {
        "thrust": w["THRUST"],
        "gravity": w["GRAVITY"],
        "kinetic": kinetic,
        "strain": strain,
        "contact_stored": stored,
        "friction": w["FRICTION"],
        "structural_damping": w["STRUCTURAL_DAMPING"],
        "released": w["RELEASED"],
    }
    # Structural damping acts between parts of one body, platform with rails: it has no resultant,
    # and so no axial part.
    across = total | {
        "thrust": w["THRUST"] - w["THRUST_AXIAL"],
        "gravity": w["GRAVITY"] - w["GRAVITY_AXIAL"],
        "kinetic": kinetic - axial,
        "friction": w["FRICTION"] - w["FRICTION_AXIAL"],
        "contact_axial": w["CONTACT_AXIAL"],
    }

    def table(entries: dict[str, np.ndarray]) -> np.ndarray:
        return np.stack([entries.get(name, zero) for name in ledger.ENTRIES], axis=1)

    return table(total), table(across)


def momentum_errors(
    samples: np.ndarray, moved: Motion, mass: float, forces: np.ndarray, steps: int
) -> tuple[float, float]:
    """Errors of linear and angular momentum (``mechanics.momenta``) of samples with pad ``forces``
    (n,f,3) N, of ``steps``."""
    return momenta.errors(
        moved,
        mass,
        samples[:, observe.LINEAR : observe.LINEAR + 6],
        samples[:, observe.IMPULSE : observe.IMPULSE + 6],
        forces,
        FINITE_ELEMENTS,
        steps,
    )
