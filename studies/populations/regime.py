"""Which of many cases lie outside what a calibration was made for, without making a scene of each."""

from types import SimpleNamespace

import numpy as np

from scenes import validity


def outside(model, inputs: dict[str, np.ndarray], cases: int) -> np.ndarray:
    """Whether each of ``cases`` variations of ``model.scene`` by ``inputs`` (n,), SI, is outside ``model.calibration`` (n,) bool.

    Nothing is outside of walls, to which nothing was fitted.
    """
    fitted = model.calibration
    if fitted is None:
        return np.zeros(cases, dtype=bool)
    if any(key.startswith(("pads", "rail")) for key in inputs):
        return np.ones(cases, dtype=bool)
    found, geometry = _loads(model.scene, inputs, cases), model.scene.geometry_hash
    limited = sorted(set(found) & set(fitted.valid))
    rows = np.array([found[name] for name in limited]).reshape(
        len(limited), cases).T  # none of which differ where nothing is limited
    distinct, place = np.unique(rows, axis=0, return_inverse=True)
    flags = [bool(validity.outside(SimpleNamespace(loads=dict(zip(limited, row)), geometry_hash=geometry), fitted.valid,
                                   fitted.provenance.get("geometry_hash"))) for row in distinct]
    return np.array(flags)[place.ravel()]


def _loads(scene, inputs: dict[str, np.ndarray], cases: int) -> dict[str, np.ndarray]:
    """The loads of ``scenes.validity`` for every case, (n,) each."""
    thrusts = [key for key in inputs if key.startswith("thrust.")]
    rows = np.column_stack([inputs[key] for key in thrusts]) if thrusts else np.zeros((cases, 0))
    distinct, place = np.unique(rows, axis=0, return_inverse=True)
    found = [validity.loads(scene.replace(dict(zip(thrusts, row.tolist())))) for row in distinct]
    loads = {name: np.array([item[name] for item in found])[place.ravel()] for name in found[0]}
    if (mass := inputs.get("payload.mass")) is not None:
        loads["thrust_speed_m_s"] = loads["thrust_impulse_ns"] / mass
    if (clearance := inputs.get("contact.clearance")) is not None:
        loads["clearance_m"] = clearance
    return loads
