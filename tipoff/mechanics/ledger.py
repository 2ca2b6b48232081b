"""The two energy ledgers of a run and their residuals. Both solvers fill the same entries (J, at
each sample).

    residual = E(0) + thrust + body force - (kinetic + strain + contact_stored + contact_damping + friction
                                          + structural_damping + released + contact_axial)

E(0) is kinetic + strain + contact_stored at ignition. The **total** ledger has ``contact_axial`` =
0. The **transverse** ledger omits the axial part of every entry: the X component of each force
times the X velocity of the mass centre of its body (payload, or platform with rails), and M V_x^2 /
2 of each body in the kinetic entry. Its ``contact_axial`` is the axial work of the normal contact
forces. So 500 J of axial motion do not hide the 1 mJ that determines the rates. Both ledgers are in
the frame of the solution (``mechanics.comoving``).
"""

import numpy as np

from tipoff.mechanics import promises

BODY_FORCE = "gravity"  # the entry of the work of all body forces has the name of the first one
WORK = ("thrust", BODY_FORCE)
ENTRIES = (
    *WORK,
    "kinetic",
    "strain",
    "contact_stored",
    "contact_damping",
    "friction",
    "structural_damping",
    "released",
    "contact_axial",
)
# entries that depend only on the present state
STATE = [ENTRIES.index(name) for name in ("kinetic", "strain", "contact_stored")]
_WORK = [ENTRIES.index(name) for name in WORK]
_SPENT = [i for i in range(len(ENTRIES)) if i not in _WORK]


def residual(entries: np.ndarray) -> np.ndarray:
    """Residual (J) at each sample of a ledger (n, len(ENTRIES))."""
    initial = entries[0, STATE].sum()
    return initial + entries[:, _WORK].sum(axis=1) - entries[:, _SPENT].sum(axis=1)


def terms(entries: np.ndarray) -> float:
    """Largest sum of absolute entries (J), which determines the rounding."""
    return float(np.abs(entries).sum(axis=1).max())


def total_error(entries: np.ndarray, promised: promises.Promises = promises.RIGID) -> float:
    """Largest residual over max(|work| of each kind, summed; kinetic energy). Works may cancel, as
    for a thrust that lifts a weight. ``promises.scale`` bounds the scale from below."""
    work = np.abs(entries[:, _WORK]).sum(axis=1).max()
    largest = max(work, entries[:, ENTRIES.index("kinetic")].max())
    scale = promises.scale(largest, terms(entries), promised.energy_error, promised.rounding)
    return promises.relative(np.abs(residual(entries)).max(), scale)


def transverse_error(
    entries: np.ndarray,
    total: np.ndarray | None = None,
    promised: promises.Promises = promises.RIGID,
) -> float:
    """Largest residual over the largest sum of non-axial kinetic, strain and stored contact energy.
    The entries are differences of entries of the ``total`` ledger, if given, and have its
    rounding."""
    size = terms(entries if total is None else total)
    scale = promises.scale(
        np.abs(entries[:, STATE].sum(axis=1)).max(),
        size,
        promised.transverse_energy_error,
        promised.rounding,
    )
    return promises.relative(np.abs(residual(entries)).max(), scale)
