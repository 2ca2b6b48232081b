"""Whether the wall under a face yields against its load, so that contact has no solution.

With the stiffness K of a face whose cells all press, K = k A G in the patterns of the part that has a
wall, the equations of ``solution`` have one solution if all eigenvalues of this matrix are positive::

    1 + L' (F + mu D) L,    K = L L'

F and D are without the modes that vibrate. F is positive semidefinite, but D is not: friction may press
the wall away from the pad. It presses by less than the wall yields to pressure, unless its coefficient is
large. Vibrating modes need no such limit: what friction does to them moves them with their inertia.
"""

import numpy as np

from tipoff.lowfi.contact.compliant.parts import HALF
from tipoff.lowfi.contact.compliant.record import Compliance
from tipoff.lowfi.contact.wall_ends import ALONG
from tipoff.mechanics.rail_compliance.patterns import DRAGGED, gram


def least_share(compliance: Compliance, face: int, place: float) -> float:
    """The least eigenvalue for a ``face`` whose middle is at X = ``place`` (m), all other faces
    unloaded."""
    way = place - compliance.ahead[face] - compliance.origin
    station = int(np.clip(way // compliance.spacing, 0, len(compliance.cubic) - 1))
    powers = (way - station * compliance.spacing) ** np.arange(4)
    own, block = compliance.workspace, compliance.block[face, compliance.among[face]]
    size = own.force.shape[1]
    flexibility = (powers @ compliance.cubic[station, block]).reshape(size, size)
    if len(compliance.dragged):
        drag = (powers @ compliance.dragged[station, block]).reshape(DRAGGED, DRAGGED)
        flexibility[:DRAGGED, :DRAGGED] += own.friction[0] * drag
    half, span = np.abs(compliance.half[face]), own.part[face, HALF]
    area = 4.0 * half[0] * half[1] * span
    root = np.linalg.cholesky(compliance.interface_stiffness * area * gram(len(own.levels) - 1))
    return float(np.linalg.eigvalsh(np.eye(size) + root.T @ flexibility @ root)[0])


def words(compliance: Compliance | None, touching: np.ndarray, survey: np.ndarray) -> str:
    """Text on the first ``touching`` (f,) face that has no solution, from the last ``survey``
    (f,SURVEY_SIZE); empty if each has one."""
    if compliance is None:
        return ""
    for face in np.flatnonzero(touching).tolist():
        if least_share(compliance, face, survey[face, ALONG]) <= 0.0:
            return (
                f"under friction of {compliance.workspace.friction[0]:g} the wall of pad face {face} "
                "yields against its load: a smaller coefficient has a solution"
            )
    return ""
