"""The two energy ledgers of a run, and how well they close. Both fidelities fill the same entries (J, at each sample).

    residual = E(0) + thrust + gravity - (kinetic + strain + contact_stored + contact_damping + friction
                                          + structural_damping + released + contact_axial)

E(0) is kinetic + strain + contact_stored at ignition. The **total** ledger has ``contact_axial`` = 0. In the **transverse** ledger
the axial part is taken out of every entry: each force's X component times the X velocity of the mass centre of the body it
acts on (payload, or platform with rails); the kinetic entry loses M V_x^2 / 2 of each body. What the normal contact forces
do along X then has no other entry and stands in ``contact_axial``. So 500 J of axial motion cannot hide the 1 mJ that
decides the rates.
"""

import numpy as np

ENTRIES = ("thrust", "gravity", "kinetic", "strain", "contact_stored", "contact_damping", "friction",
           "structural_damping", "released", "contact_axial")
_STATE = [ENTRIES.index(name) for name in ("kinetic", "strain", "contact_stored")]
_WORK = [ENTRIES.index(name) for name in ("thrust", "gravity")]
_SPENT = [i for i in range(len(ENTRIES)) if i not in _WORK]


def residual(entries: np.ndarray) -> np.ndarray:
    """Residual (J) at each sample of a ledger (n, len(ENTRIES))."""
    initial = entries[0, _STATE].sum()
    return initial + entries[:, _WORK].sum(axis=1) - entries[:, _SPENT].sum(axis=1)


def total_error(entries: np.ndarray) -> float:
    """Largest residual over max(|work|, largest kinetic energy)."""
    work = np.abs(entries[:, _WORK].sum(axis=1)).max()
    return _ratio(np.abs(residual(entries)).max(), max(work, entries[:, ENTRIES.index("kinetic")].max()))


def transverse_error(entries: np.ndarray) -> float:
    """Largest residual over the largest sum of non-axial kinetic, strain and stored contact energy."""
    return _ratio(np.abs(residual(entries)).max(), np.abs(entries[:, _STATE].sum(axis=1)).max())


def _ratio(residual_j: float, scale_j: float) -> float:
    # A scene in which nothing ever moves has no scale; its residual is then exactly zero too.
    return float(residual_j / scale_j) if scale_j > 0.0 else float(residual_j)
