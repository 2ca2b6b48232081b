"""Stage ``calibrate``: the surrogate's contact constants from the reference's curves of the fitted conditions, and nothing else."""

from pathlib import Path

import numpy as np

from scenes.calibration import Calibration
from studies.progress import Board
from studies.store import SOURCES
from studies.study import Study, StudyError, require_success

FILE = "calibration.toml"
_SOURCES = (*SOURCES["highfi"], *SOURCES["lowfi"], "calibrate")


def run(study: Study) -> dict:
    """The calibration as plain values, beside ``calibration.toml``."""
    names = study.fitted()
    asked = [study.highfi(name) for name in names]

    def make() -> tuple[dict, list[Path]]:
        import calibrate

        references = dict(zip(names, study.store.fill("highfi", asked)))
        require_success(references, "calibrate")
        with Board("calibrate", 1) as board:
            try:
                found = calibrate.run(study.scene, references, progress=board.callback("calibrate"))
            except calibrate.CalibrationError as fault:
                raise StudyError(f"cannot calibrate: {fault}") from None
            board.finished("calibrate", f"objective {found.objective:.4g}")
        path = study.path(FILE)
        found.save(path)
        return as_dict(found) | {"calibration": study.relative(path)}, [path]

    return study.stage("calibration", study.key(_SOURCES, [item.key for item in asked]), make)


def load(study: Study) -> Calibration:
    """The calibration of this scene, made if it is not there."""
    run(study)
    return Calibration.load(study.path(FILE))


def as_dict(found: Calibration) -> dict:
    """Plain values of a calibration."""
    return {"constants": found.constants, "parameters": found.parameters, "values": list(found.values),
            "units": found.units, "lower": list(found.lower), "upper": list(found.upper),
            "justification": found.justification, "information": np.asarray(found.information).tolist(),
            "weak_directions": found.weak_directions, "residuals": found.residuals, "conditions": found.conditions,
            "objective": float(found.objective), "valid": found.valid, "provenance": found.provenance}
