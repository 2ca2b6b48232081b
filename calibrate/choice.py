"""Selection of the parameters of a fit on compliant contact: those named by the user, or else those
that the curves determine. The information matrix at the scene's values decides. Candidates are the
constants of contact and, on request (``ALL``), errors of mounting.

The parameter with the most information is taken first, then the one with the most information left
when the taken ones are fitted again, and so on: Cholesky's factorisation with diagonal pivoting
(Golub and Van Loan, Matrix Computations, section 4.2). It ends when the remaining information
changes the curves by less than 0.5 % over a tenth of the bounds (``information.WEAK_EIGENVALUE``).
The other parameters keep the scene's values. Of parameters with the same effect, such as line of
thrust and mass centre before any contact, one is taken.
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from tipoff.calibration import alignment, compliant
from tipoff.calibration.faults import CalibrationError
from tipoff.calibration.information import WEAK_EIGENVALUE, information, jacobian
from tipoff.calibration.parameters import Parameter, siblings
from tipoff.faults import close
from tipoff.scenes.scene import Scene

ALL = "all"


def parameters(
    scene: Scene, conditions: Iterable[str], fit: Sequence[str] | None, make: Callable
) -> tuple[list[Parameter], list[Parameter], list[str]]:
    """Parameters of the fit, candidates held at the scene's values, and sentences on parameters
    that are no candidates. ``fit`` is None for constants of contact, ``[ALL]`` for all parameters.
    ``make`` gives the objective of a list of parameters."""
    if fit is not None and list(fit) != [ALL]:
        return named(scene, conditions, fit), [], []
    items = _candidates(scene, fit)
    stated = {item.name: _stated(scene, conditions, item.name) for item in items}
    items = [item for item in items if not stated[item.name]]
    reasons = [reason for found in stated.values() for reason in found[:1]]
    own = np.clip([item.share(item.read(scene)) for item in items], 0.0, 1.0)
    taken = determined(information(jacobian(make(items), own))) if items else []
    if not taken:
        none = [f"the curves determine none of {', '.join(item.name for item in items)}"]
        faults = [f"fit: {text}" for text in reasons + (none if items else [])]
        raise CalibrationError(
            "\n  ".join([f"cannot calibrate {scene.name}", *faults, "name what to fit"])
        )
    held = [item for number, item in enumerate(items) if number not in taken]
    return [items[number] for number in taken], held, reasons


def most(scene: Scene, fit: Sequence[str] | None) -> int:
    """Largest number of parameters of a fit of ``scene`` for this ``fit``."""
    if fit is not None and list(fit) != [ALL]:
        return len(fit)
    return len(_candidates(scene, fit))


def moves_free_flight(scene: Scene, fit: Sequence[str] | None, springs: bool = False) -> bool:
    """Whether a fit may contain errors of mounting, which change the rates before any contact."""
    if springs:
        return False
    names = [item.name for item in _candidates(scene, fit)] if fit in (None, [ALL]) else list(fit)
    return not set(alignment.NAMES).isdisjoint(names)


def _candidates(scene: Scene, fit: Sequence[str] | None) -> list[Parameter]:
    contact = compliant.free(scene)
    return contact if contact and fit is None else [*contact, *alignment.free(scene)]


def require_parameters(scene: Scene, conditions: Iterable[str], fit: Sequence[str]) -> None:
    """Raise CalibrationError with every fault if ``fit`` cannot be fitted to ``conditions``."""
    if list(fit) != [ALL]:
        named(scene, conditions, fit)


def named(scene: Scene, conditions: Iterable[str], names: Sequence[str]) -> list[Parameter]:
    """The parameters with these ``names``. Raises CalibrationError with every fault: an unknown
    parameter, a repeated one, a missing table of the scene, a constant that a fitted condition
    states itself."""
    known = {item.name: item for item in [*compliant.free(scene), *alignment.free(scene)]}
    known |= {item.name: item for item in compliant.along_axes(scene)}
    faults = [] if names else ["fit: given nothing, expected at least one parameter"]
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            faults.append(f"fit: {name} is named {names.count(name)} times")
        if name == ALL:
            faults.append(f"fit: given {ALL} and names, expected {ALL} or names")
        elif name not in every_name():
            meant = close(name, every_name())
            faults.append(f"fit: {name!r} is none of {', '.join(every_name())}{meant}")
        elif name not in known:
            faults.append(f"fit: {name} needs {compliant.needs(name)}, which the scene lacks")
        else:
            faults += [f"fit: {text}" for text in _stated(scene, conditions, name)]
    if set(compliant.AXES) <= set(names) and compliant.CLEARANCE in names:
        faults.append(
            f"fit: {compliant.CLEARANCE} has no effect beside {' and '.join(compliant.AXES)}"
        )
    if faults:
        raise CalibrationError("\n  ".join([f"cannot calibrate {scene.name}", *faults]))
    return [known[name] for name in names]


def every_name() -> list[str]:
    """Names of all parameters that some scene has."""
    return [*compliant.KEYS, *alignment.NAMES]


def determined(matrix: np.ndarray) -> list[int]:
    """Numbers of the parameters that the information ``matrix`` (p,p) determines, in its order."""
    rest, taken = np.array(matrix), []
    for _ in range(len(rest)):
        best = int(np.argmax(np.diag(rest)))
        if rest[best, best] < WEAK_EIGENVALUE:
            break
        taken.append(best)
        column = rest[:, best] / np.sqrt(rest[best, best])
        rest = rest - np.outer(column, column)
        rest[taken, taken] = 0.0  # rounding must not be taken again
    return sorted(taken)


def _stated(scene: Scene, conditions: Iterable[str], name: str) -> list[str]:
    """Sentences on conditions that state the constant ``name``: one value cannot replace the values
    of several conditions. A change is added to them."""
    if name in alignment.NAMES:
        return []
    return [
        f"{name} is stated by condition {condition} itself ({key}), so one value cannot serve all"
        for condition in conditions
        for key in scene.conditions.get(condition, {})
        if any(f"{other}.".startswith(f"{key}.") for other in siblings(name))
    ]
