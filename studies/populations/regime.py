"""Which of many cases lie outside what a calibration was made for, without making a scene of each.

To the ranges of ``scenes.validity`` comes the transverse moment impulse, for that is what the errors of assembly change: constants
fitted where an error of 0.1 deg presses pads on rails are extrapolated at 1 deg. One run passes through every load below its
largest, so only more than the largest of the fitted conditions is outside.
"""

from types import SimpleNamespace

import numpy as np

from scenes import validity
from studies.populations import moments
from studies.populations.moments import Inputs


def outside(model, inputs: Inputs, cases: int) -> np.ndarray:
    """Whether each of ``cases`` variations of ``model.scene`` by ``inputs`` (n,), SI, is outside ``model.calibration``, or has a
    larger moment impulse than ``model.moment``, (n,) bool.

    A NaN input stands for the scene's own number. Nothing is outside of walls, to which nothing was fitted.
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
    known = np.array(flags)[place.ravel()]
    if model.moment is None:
        return known
    return known | (moments.transverse(model.scene, inputs, found["thrust_impulse_ns"]) > (1.0 + validity.MARGIN) * model.moment)


def _loads(scene, inputs: Inputs, cases: int) -> dict[str, np.ndarray]:
    """The loads of ``scenes.validity`` for every case, (n,) each."""
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
    return loads
