"""Choice of the model by options; compliant contact is the default. An option of another model is
bad input."""

from pathlib import Path
from typing import Any, NamedTuple

from tipoff.faults import Fault, SceneError
from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, MODELS, SURROGATES

_OWNERS = {
    "--calibration": SURROGATES,
    "--modes": (COMPLIANT,),
    "--degree": (COMPLIANT,),
    "--cells": (COMPLIANT,),
    "--checkpoint-every": (FINITE_ELEMENTS,),
}


class ModelOptions(NamedTuple):
    """Options of a model."""

    name: str | None = None  # None: the default
    calibration: Path | None = None  # file, of a surrogate
    modes: int | str | None = None  # of each rail on compliant contact; None: "auto"
    degree: int | str | None = None  # of the patterns on a pad face; None: the default
    cells: int | None = None  # along each edge of a pad face; None: the default

    @property
    def asked(self) -> int | str:
        """The modes for the numerics."""
        return AUTO if self.modes is None else self.modes

    @property
    def numerics(self) -> dict[str, Any]:
        """Numerics of a run on compliant contact."""
        others = {"degree": self.degree, "cells": self.cells}
        given = {name: value for name, value in others.items() if value is not None}
        return {"modes": self.asked} | given

    @property
    def model(self) -> str:
        """The name of the model."""
        return self.name or COMPLIANT


def require(options: ModelOptions, **others: object) -> None:
    """Raise SceneError with every fault: an unknown name of a model, and options of another model.
    ``others`` are further options by the name of their parameter, None if not given."""
    if options.model not in MODELS:
        raise SceneError([Fault("--model", "name", options.model, f"one of {', '.join(MODELS)}")])
    given: dict[str, object] = {
        "--calibration": options.calibration,
        "--modes": options.modes,
        "--degree": options.degree,
        "--cells": options.cells,
    }
    given |= {f"--{name.replace('_', '-')}": value for name, value in others.items()}
    faults = [
        Fault(
            option,
            "option",
            str(value),
            f"none with --model {options.model}: it is an option of {' and '.join(_OWNERS[option])}",
        )
        for option, value in given.items()
        if value is not None and options.model not in _OWNERS[option]
    ]
    if faults:
        raise SceneError(faults)
