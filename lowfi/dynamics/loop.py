"""State of the time loop: values that evolve from step to step, as arrays and records with named
fields. The kernels change them in place."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.memory import zeros
from tipoff.kernels.reference import by_reference
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant.record import states
from tipoff.lowfi.contact.stick_slip import ROW_SIZE
from tipoff.lowfi.contact.wall_ends import SURVEY_SIZE
from tipoff.lowfi.dynamics.dormand_prince import STAGES
from tipoff.mechanics.books import BOOK_SIZE

CLOCK = np.dtype(
    [
        ("began", "f8"),  # s, start of the last step
        ("now", "f8"),  # s, end of the last step
        ("dt", "f8"),  # s, size of the last step before an event cut it
        ("kept", "f8"),  # fraction of that step up to the event; 1 without one
        ("wanted", "f8"),  # s, step size that error control proposes
        ("rate", "f8"),  # 1/s, bound of the contact's eigenvalues at the end of the step
        ("growth", "f8"),  # of that bound in the last step, relative
        ("limit", "f8"),  # s, smallest proven step limit so far
        ("limit_used", "f8"),  # largest ratio of a step to its limit
        ("friction_power", "f8"),  # W, largest so far; friction that dissipates has none above 0
        ("damping_power", "f8"),  # W, the same for contact damping
    ],
    align=True,
)
COUNTS = np.dtype(
    [
        ("segment", "i8"),  # number of the stop that the step must not pass; -1 before the first
        ("steps", "i8"),  # accepted
        ("rejected", "i8"),
        ("events", "i8"),
        ("evaluations", "i8"),  # of the right-hand side
        ("samples", "i8"),  # taken so far; -1 before the run has begun
        ("striking_face", "i8"),  # face that strikes an edge of its wall, or -1
        ("apart", "?"),  # whether A of each body is about its mass centre (``lowfi.state``)
    ],
    align=True,
)
AUDIT = np.dtype(
    [
        ("first", "f8"),  # J, balance of the total ledger at ignition
        ("first_transverse", "f8"),  # J, the same of the transverse ledger
        ("error", "f8"),  # J, change of the balance since
        ("error_transverse", "f8"),  # J
        ("peak_error", "f8"),  # J, largest size of that so far
        ("peak_error_transverse", "f8"),  # J
        ("scale", "f8"),  # J, largest work or kinetic energy so far
        ("scale_transverse", "f8"),  # J
        ("terms", "f8"),  # J, largest sum of the sizes of all terms, which sets the rounding
        ("dissipated", "f8"),  # J, the most that has left the contacts
        ("created", "f8"),  # J, the most that came back of it
        ("in_compliance", "f8"),  # J, stored in compliant contact at the last survey
        ("failed", "?"),  # a tenth of the scale is lost
    ],
    align=True,
)


@by_reference
class Plan(NamedTuple):
    """Times at which steps must end, and their largest length."""

    stops: np.ndarray  # (s,) s, times at which a step must end; the last is the end of the scene
    caps: np.ndarray  # (s,) s, longest step before each stop
    maximum_steps: int
    first: float  # s, first attempted step; error control corrects it in a few attempts


@by_reference
class Sampling(NamedTuple):
    """Samples to take, and their arrays."""

    interval: float  # s, between samples
    last: int  # number of the last sample in the scene
    number: int  # number of the sample to stop at; -1 without samples
    whole: bool  # continue to the end of the scene, even if exit and jam are settled
    rows: np.ndarray  # (n, SAMPLE_SIZE), filled up to ``number``
    forces: np.ndarray  # (n, f, 3) N, of each pad face on the payload
    loads: np.ndarray  # largest loads of the guides (``dynamics.sample``), of none without samples


@by_reference
class Loop(NamedTuple):
    """Evolving values, for f faces and a state of n numbers (STATE_SIZE and those of the modes)."""

    start: np.ndarray  # (n,) state at the start of the last step
    end: np.ndarray  # (n,) state at its end
    stages: np.ndarray  # (STAGES, n) derivatives
    before: np.ndarray  # (f, SURVEY_SIZE) survey of the start
    after: np.ndarray  # (f, SURVEY_SIZE) survey of the end
    engaged: np.ndarray  # (f,) whether a face is over its wall
    depth_left: np.ndarray  # (f,) m, penetration at which a face left that is still partly over
    touching: np.ndarray  # (f,) whether a face touches its wall in the step
    stick: np.ndarray  # (f, ROW_SIZE) stick-slip state
    clock: np.record  # CLOCK
    counts: np.record  # COUNTS
    work: np.ndarray  # (n,) workspace
    book: np.ndarray  # (BOOK_SIZE,) exit, settled window and jam (``mechanics.books``)
    audit: np.record  # AUDIT, of the energy ledgers (``lowfi.dynamics.audit``)


def allocate(system) -> Loop:
    """A loop of zeros for ``system``."""
    faces, size = system.faces.shape[0], slot.STATE_SIZE + states(system.compliance)
    return Loop(
        start=zeros((size,)),
        end=zeros((size,)),
        stages=zeros((STAGES, size)),
        before=zeros((faces, SURVEY_SIZE)),
        after=zeros((faces, SURVEY_SIZE)),
        engaged=np.zeros(faces, dtype=np.bool_),
        depth_left=zeros((faces,)),
        touching=np.zeros(faces, dtype=np.bool_),
        stick=zeros((faces, ROW_SIZE)),
        clock=record(CLOCK),
        counts=record(COUNTS),
        work=zeros((size,)),
        book=zeros((BOOK_SIZE,)),
        audit=record(AUDIT),
    )


def record(kind: np.dtype) -> np.record:
    """A record of zeros, whose fields kernels read and write by name."""
    return np.zeros(1, kind).view(np.recarray)[0]
