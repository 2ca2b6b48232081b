"""Checks of the input of a calibration, before the search."""

from collections.abc import Mapping, Sequence

from tipoff.comparison.curves import Curves
from tipoff.faults import Fault, InputError, SceneError, kind_of
from tipoff.mechanics.laws import thrust
from tipoff.mechanics.model_names import SPRINGS
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.rounding import apart
from tipoff.scenes.scene import Scene
from tipoff.units import duration


class CalibrationError(InputError):
    """References or a scene that cannot be used for a fit; the message lists every fault."""


def check(scene: Scene, references: Mapping[str, Trajectory | Curves]) -> None:
    """Raise CalibrationError with every fault of the input, SceneError for an unknown condition.

    Runs must cover ``agreement.fitted``; other curves are fitted as given.
    """
    if not isinstance(references, Mapping):
        expected = "runs or calibration.Curves by the name of their condition"
        raise SceneError([Fault("arguments", "references", kind_of(references), expected)])
    wrong = [
        Fault("arguments", f"references.{name}", kind_of(reference), "a Trajectory or Curves")
        for name, reference in references.items()
        if not isinstance(reference, (Trajectory, Curves))
    ]
    if wrong:
        raise SceneError(wrong)
    faults = []
    fitted = list(scene.agreement.fitted)
    if not references:
        faults.append(
            f"references: given none, expected one for each of "
            f"{', '.join(fitted) or 'the fitted conditions'}"
        )
    if all(isinstance(reference, Trajectory) for reference in references.values()):
        faults += [
            f"references: {name} is missing, expected every condition of agreement.fitted"
            for name in fitted
            if references and name not in references
        ]
    for name, reference in references.items():
        faults += [
            f"references: {name} {words}" for words in _unfit(scene.condition(name), reference)
        ]
    if faults:
        raise CalibrationError("\n  ".join([f"cannot calibrate {scene.name}", *faults]))


def require_model(scene: Scene, model: str, fit: Sequence[str] | None) -> None:
    """Raise CalibrationError if springs cannot be fitted: without contact there are no springs, and
    their contact law determines the parameters."""
    faults = []
    if model == SPRINGS and scene.contact is None:
        faults.append("contact: given no table, expected one: without contact there are no springs")
    if model == SPRINGS and fit is not None:
        faults.append(
            f"fit: given {', '.join(fit)}, expected none with springs, whose contact law determines "
            "the parameters"
        )
    if faults:
        raise CalibrationError("\n  ".join([f"cannot calibrate {scene.name}", *faults]))


def _unfit(scene: Scene, reference: Trajectory | Curves) -> list[str]:
    """Reasons why the settled rate of a reference cannot be compared with a run of ``scene``."""
    if isinstance(reference, Trajectory):
        return (
            []
            if reference.status == "exited"
            else [f"is {reference.status}, expected exited: no settled rate can be fitted"]
        )
    (burnt,) = thrust.burnouts(scene.thrust.record(), (1e-3,), scene.time_limit)
    # a record ends with a sample, usually not with the window
    last_step = float(reference.time[-1] - reference.time[-2])
    found = []
    if reference.window_start < burnt - last_step:
        settles, ends = apart(reference.window_start, burnt, 6, duration)
        found.append(
            f"settles from {settles}, expected no earlier than {ends}, when "
            "thrust falls below 0.1 % of its peak: the record is too short"
        )
    if reference.time[-1] > scene.time_limit * (1.0 + 1e-12):
        lasts, most = apart(float(reference.time[-1]), scene.time_limit, 6, duration)
        found.append(
            f"lasts {lasts}, expected at most the scene's duration of "
            f"{most}: settle earlier, or raise the duration"
        )
    return found
