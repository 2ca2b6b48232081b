"""Which of many cases lie outside what a calibration was made for (``scenes.validity``), without making a scene of each."""

import numpy as np

from scenes import moments, validity
from scenes.moments import Inputs


def outside(model, inputs: Inputs, cases: int) -> np.ndarray:
    """Whether each of ``cases`` variations of ``model.scene`` by ``inputs`` (n,), SI, is outside ``model.calibration``, (n,) bool.

    A NaN input stands for the scene's own number. Nothing is outside of walls, to which nothing was fitted.
    """
    fitted = model.calibration
    if fitted is None:
        return np.zeros(cases, dtype=bool)
    other_rail = fitted.provenance.get("geometry_hash") not in (None, model.scene.geometry_hash)
    if other_rail or any(key.startswith(("pads", "rail")) for key in inputs):
        return np.ones(cases, dtype=bool)
    flags = np.zeros(cases, dtype=bool)
    for name, values in _loads(model.scene, inputs, cases).items():
        if name in fitted.valid:
            flags |= validity.beyond(values, fitted.valid[name])
    return flags


def _loads(scene, inputs: Inputs, cases: int) -> dict[str, np.ndarray]:
    """The loads of ``scenes.validity`` for every case, (n,) each or () where all cases have the scene's."""
    thrusts = [key for key in inputs if key.startswith("thrust.")]
    rows = np.column_stack([inputs[key] for key in thrusts]) if thrusts else np.zeros((cases, 0))
    distinct, place = np.unique(rows, axis=0, return_inverse=True)
    found = [validity.loads(scene.replace({key: value for key, value in zip(thrusts, row.tolist()) if value == value}))
             for row in distinct]
    loads = {name: np.array([item[name] for item in found])[place.ravel()] for name in found[0]}
    if "payload.mass" in inputs:
        loads["thrust_speed_m_s"] = loads["thrust_impulse_ns"] / moments.column(scene, inputs, "payload.mass")
    if "contact.clearance" in inputs:
        loads["clearance_m"] = moments.column(scene, inputs, "contact.clearance")
    return loads | {"moment_impulse_nms": moments.transverse(scene, inputs, loads["thrust_impulse_ns"])}
