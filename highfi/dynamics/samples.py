"""Ledgers, momentum checks and the motion of a Trajectory, from sample vectors."""

import math

import numpy as np

from tipoff.highfi.dynamics import observe
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.state import records
from tipoff.kernels import rotation
from tipoff.mechanics import ledger, momenta
from tipoff.mechanics.outcome import Motion
from tipoff.mechanics.promises import FINITE_ELEMENTS


def motion(samples: np.ndarray, interval: float, body_offset: np.ndarray) -> Motion:
    """Motion of samples (n, SAMPLE_SIZE); ``body_offset`` (3,) m points from the frame's origin to
    the platform's mass centre."""

    def part(first, size=3):
        return samples[:, first : first + size].copy()

    frame = rotation.matrices(part(observe.PLATFORM_QUATERNION, 4))
    offset = frame @ body_offset
    spin = np.einsum("nij,nj->ni", frame, part(observe.PLATFORM_RATE))
    return Motion(
        time=np.arange(len(samples)) * interval,
        position=part(observe.POSITION),
        velocity=part(observe.VELOCITY),
        quaternion=part(observe.QUATERNION, 4),
        rate=part(observe.RATE),
        platform_position=part(observe.PLATFORM_POSITION) + offset,
        platform_velocity=part(observe.PLATFORM_VELOCITY) + np.cross(spin, offset),
        platform_quaternion=part(observe.PLATFORM_QUATERNION, 4),
        platform_rate=part(observe.PLATFORM_RATE),
    )


def ledgers(samples: np.ndarray, work: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Total and transverse ledger (n, len(ENTRIES)) J of samples and accumulated work (n,2) WORK.

    Structural damping acts within one body, the platform with its rails. So it has no resultant and
    no axial part.
    """
    book = work.view(float).reshape(len(samples), 2, len(ledger.ENTRIES))
    total, across = book[:, records.TOTAL].copy(), book[:, records.TOTAL] - book[:, records.AXIAL]
    kinetic, strain, stored, contact = (
        ledger.ENTRIES.index(name)
        for name in ("kinetic", "strain", "contact_stored", "contact_axial")
    )
    for table in (total, across):
        table[:, kinetic] = samples[:, observe.KINETIC]
        table[:, strain] = samples[:, observe.STRAIN]
        table[:, stored] = samples[:, observe.CONTACT]
    across[:, kinetic] -= samples[:, observe.AXIAL_KINETIC]
    across[:, contact] = book[:, records.AXIAL, contact]
    return total, across


def momentum_errors(
    samples: np.ndarray, moved: Motion, system: System, forces: np.ndarray, steps: int
) -> tuple[float, float]:
    """Errors of linear and angular momentum (``mechanics.momenta``) of samples with pad ``forces``
    (n,f,3) N, of ``steps``."""
    model, drive = system.model, system.drive
    given = samples[:, observe.IMPULSE : observe.IMPULSE + 6]
    mass = model.payload.mass + (
        drive.moving_mass if system.frame is None else system.frame.total_mass
    )
    levers = momenta.size(model.faces.centre).max() + momenta.size(system.rail.points).max()
    places = (moved.position, moved.platform_position)
    sums = momenta.Sums(
        values=samples[:, observe.LINEAR : observe.LINEAR + 6],
        given=given,
        sizes=momenta.Sizes(*samples[:, observe.SIZES :].T),
        impulses=momenta.impulses(
            moved.time, given, forces, mass * math.hypot(*(model.body_force or ()))
        ),
        reach=float(max(momenta.size(place).max() for place in places) + levers),
    )
    return momenta.errors(sums, FINITE_ELEMENTS, steps)
