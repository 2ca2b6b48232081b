"""The two energy ledgers of a run, and how well they close. Both fidelities fill the same entries
(J, at each sample).

    residual = E(0) + thrust + body force - (kinetic + strain + contact_stored + contact_damping + friction
                                          + structural_damping + released + contact_axial)

E(0) is kinetic + strain + contact_stored at ignition. The **total** ledger has ``contact_axial`` =
0. In the **transverse** ledger the axial part is taken out of every entry: each force's X component
times the X velocity of the mass centre of the body it acts on (payload, or platform with rails);
the kinetic entry loses M V_x^2 / 2 of each body. What the normal contact forces do along X then has
no other entry and stands in ``contact_axial``. So 500 J of axial motion cannot hide the 1 mJ that
decides the rates. Both are kept in the frame a run is solved in (``mechanics.comoving``): where the
platform flies by at 7.5 km/s, the energy of that flight is no scale for anything.
"""

import numpy as np

from tipoff.mechanics import promises
from tipoff.scenes.effects.registry import EFFECTS

# One entry holds the work of all body forces. It has the name of the first one.
BODY_FORCE = next(effect.key for effect in EFFECTS if effect.is_body_force)
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
_STATE = [ENTRIES.index(name) for name in ("kinetic", "strain", "contact_stored")]
_WORK = [ENTRIES.index(name) for name in WORK]
_SPENT = [i for i in range(len(ENTRIES)) if i not in _WORK]


def residual(entries: np.ndarray) -> np.ndarray:
    """Residual (J) at each sample of a ledger (n, len(ENTRIES))."""
    initial = entries[0, _STATE].sum()
    return initial + entries[:, _WORK].sum(axis=1) - entries[:, _SPENT].sum(axis=1)


def terms(entries: np.ndarray) -> float:
    """Size (J) of what is summed, and so of what rounds: the largest sum of absolute entries."""
    return float(np.abs(entries).sum(axis=1).max())


def total_error(entries: np.ndarray, promised: promises.Promises = promises.RIGID) -> float:
    """Largest residual over max(|work|, largest kinetic energy), at least what rounding of the
    ``terms`` leaves to be told of what is ``promised``."""
    work = np.abs(entries[:, _WORK].sum(axis=1)).max()
    largest = max(work, entries[:, ENTRIES.index("kinetic")].max())
    scale = promises.scale(largest, terms(entries), promised.energy_error, promised.rounding)
    return promises.relative(np.abs(residual(entries)).max(), scale)


def transverse_error(
    entries: np.ndarray,
    total: np.ndarray | None = None,
    promised: promises.Promises = promises.RIGID,
) -> float:
    """Largest residual over the largest sum of non-axial kinetic, strain and stored contact energy.
    Its entries are differences of those of the ``total`` ledger, if given, and round as these
    do."""
    size = terms(entries if total is None else total)
    scale = promises.scale(
        np.abs(entries[:, _STATE].sum(axis=1)).max(),
        size,
        promised.transverse_energy_error,
        promised.rounding,
    )
    return promises.relative(np.abs(residual(entries)).max(), scale)
