"""Stage ``recovery``: whether a calibration of compliant contact finds hidden values.

Twenty draws change values near the scene's. The curves of the surrogate with these values get 2 % of
noise, and a fit from the scene's values gives intervals. Rates are compared on a held-out condition. Then
clearance and friction are hidden in one run of the reference.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError, require_success
from tipoff.workspace.words import counted

if TYPE_CHECKING:
    from validation.recovery.draws import Draw

# hidden value over the scene's, in the reference
HIDDEN = {"contact.clearance": 1.05, "friction.dynamic": 0.65}
_CONDITIONS = 3


@dataclass(frozen=True)
class RecoveryOptions:
    """Number of ``draws``, ``noise`` of a curve relative to its largest value, ``seed``."""

    draws: int = 20
    noise: float = 0.02
    seed: int = 0


def run(study: Study, options: RecoveryOptions = RecoveryOptions()) -> Made[dict]:
    """``rows``: parameter, number of draws in which each interval contains the hidden value, number
    of draws that do not determine it, and the median half width (SI) of the others, None without
    any; ``held_out``: largest errors of the settled rates (deg/s) of a held-out condition, or of a
    fitted one without any; ``reference``: hidden and found values in the reference.

    Raises StudyError for a scene without contact, clearance or friction, whose values are hidden.
    """
    scene = study.scene
    if scene.contact is None or scene.contact.clearance == 0.0 or scene.friction is None:
        raise StudyError("recovery hides clearance and friction, and this scene lacks one of them")
    study.fitted()  # raises without one

    def make() -> tuple[dict, list[Path]]:
        return {
            "asked": STAGE.plain(options),
            **_drawn(study, options),
            "reference": _in_reference(study),
        }, []

    return STAGE.run(study, options, make)


STAGE: Stage[dict] = Stage("recovery", __name__, options=RecoveryOptions)


def _drawn(study: Study, options: RecoveryOptions) -> dict:
    from tipoff import lowfi
    from validation.recovery.draws import drawn_and_fitted

    scene, names = study.scene, study.fitted()[:_CONDITIONS]
    other = (*scene.agreement.held_out, names[0])[0]
    compliance, condition = study.rail_compliance(scene), scene.condition(other)
    generator, draws, errors = np.random.default_rng(options.seed), [], []
    with Board("recovery", 1) as board:
        report = board.callback(label := counted(options.draws, "draw"))
        for number in range(options.draws):
            one = drawn_and_fitted(scene, names, compliance, options.noise, generator)
            draws.append(one)
            varied = (one.truth(condition), one.found.apply(condition), condition)
            runs = {
                f"{other}, {name}": lowfi.run(each, compliance=compliance)
                for name, each in zip(("hidden", "fitted", "scene"), varied)
            }
            require_success(runs, "compare rates")
            rates = np.degrees([np.array(run.outcome.rate, dtype=float) for run in runs.values()])
            errors.append(np.abs(rates[1:] - rates[0]).max(axis=1))
            report((number + 1) / options.draws)
        board.finished(label, "fitted")
    fitted, own = np.max(errors, axis=0).tolist()
    held_out = {"condition": other, "fitted_deg_s": fitted, "scene_deg_s": own}
    return {"conditions": names, "rows": rows(draws), "held_out": held_out}


def rows(draws: Sequence["Draw"]) -> list[dict]:
    """One row for each parameter of the ``draws``."""
    scatter, whole = (
        np.sum([one.inside(getattr(one.found, kind)) for one in draws], axis=0)
        for kind in ("intervals", "with_model_error")
    )
    ends = np.array([one.found.intervals for one in draws])
    found = []
    for place, (name, unit) in enumerate(zip(draws[0].found.parameters, draws[0].found.units)):
        known = ends[np.isfinite(ends[:, place]).all(axis=1), place]
        found.append(
            {
                "parameter": name,
                "unit": unit,
                "covered": int(scatter[place]),
                "covered_with_model_error": int(whole[place]),
                "undetermined": len(draws) - len(known),
                "half_width": 0.5 * float(np.median(np.diff(known))) if len(known) else None,
            }
        )
    return found


def _in_reference(study: Study) -> dict:
    from tipoff import calibration

    scene, name = study.scene, (*study.scene.agreement.refined, *study.fitted())[0]
    assert scene.contact is not None and scene.friction is not None
    hidden = {
        "contact.clearance": HIDDEN["contact.clearance"] * scene.contact.clearance,
        "friction.dynamic": HIDDEN["friction.dynamic"] * scene.friction.dynamic,
    }
    static = HIDDEN["friction.dynamic"] * scene.friction.static
    request = study.highfi(name, hidden | {"friction.static": static}, "-hidden")
    references = dict(zip([name], study.store.fill("recovery, highfi", [request])))
    require_success(references, "recover what is hidden in the reference")
    found = calibration.run(
        scene.replace({"agreement.fitted": [name]}),
        references,
        compliance=study.rail_compliance(study.condition(name)),
        fit=list(hidden),
    )
    return {
        "condition": name,
        "element_size_m": study.settings.element_size,
        "rows": [
            {
                "parameter": parameter,
                "unit": unit,
                "hidden": value,
                "found": fitted,
                "interval": [end if np.isfinite(end) else None for end in ends],
            }
            for (parameter, value), unit, fitted, ends in zip(
                hidden.items(), found.units, found.values, found.with_model_error
            )
        ],
    }
