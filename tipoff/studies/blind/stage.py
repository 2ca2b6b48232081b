"""Stage ``blind``: agreement on conditions drawn at random after all constants are fixed.

The authors of a surrogate can see held-out conditions. Blind conditions are drawn from distributions of
errors. The default seed is a digest of the sources and the scene, so any change of the code draws other
conditions. They are judged like chosen conditions: as curves, or as distributions if no single run can
judge.
"""

from dataclasses import asdict, dataclass, replace
from pathlib import Path

from tipoff import sources
from tipoff.files import content_hash
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import halving, uncertainty
from tipoff.studies.agreement import judging, verdicts
from tipoff.studies.agreement.candidates import calibrated, compliant
from tipoff.studies.agreement.distributions import Distribution
from tipoff.studies.agreement.growth import Growth
from tipoff.studies.agreement.options import CASES, CompareOptions
from tipoff.studies.agreement.verdicts import Gates, JudgedCondition
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

NAME = "blind"
_CODE = ("tipoff.highfi", "tipoff.lowfi", "tipoff.calibration")


@dataclass(frozen=True, kw_only=True)
class Blind:
    """Rows of ``calibrated`` springs and of ``compliant`` contact, ``growth`` of a 1 um disturbance
    and ``distributions``, as in the agreement study, and the drawn ``conditions``: overrides in SI, from
    the distributions ``errors``: a file, or its name in the catalogue; ``sizes``: 95 % of the values of each
    tolerance (``scenes.halving``)."""

    asked: CompareOptions
    errors: str
    sizes: dict[str, str]
    seed: int
    gates: Gates
    converged_deg_s: float
    clearance_change_m: float
    conditions: dict[str, dict[str, float]]
    calibrated: tuple[JudgedCondition, ...]
    compliant: tuple[JudgedCondition, ...]
    growth: tuple[Growth, ...]
    distributions: tuple[Distribution, ...]


def run(study: Study, options: CompareOptions = CompareOptions()) -> Made[Blind]:
    """The verdicts on drawn conditions."""
    drawn = with_drawn_conditions(study, options)
    compared = [calibrated(study), compliant(drawn, drawn.conditions)]

    def make() -> tuple[Blind, list[Path]]:
        curves = judging.as_curves(drawn, compared, "judge blind conditions")
        draws = options.neighbours or study.settings.neighbours
        found = judging.judge(drawn, compared, curves, draws)
        return Blind(
            asked=options,
            errors=uncertainty.chosen(options.vary, study.scene),
            sizes=halving.sizes(_drawn(study, options).uncertainty),
            seed=seed_of(study, options),
            gates=verdicts.gates(study.scene),
            converged_deg_s=verdicts.CONVERGED_DEG_S,
            clearance_change_m=study.settings.clearance_change,
            conditions=drawn.scene.conditions,
            **{name: tuple(rows) for name, rows in found.rows.items()},
            growth=tuple(found.growths),
            distributions=tuple(found.distributions),
        ), []

    return STAGE.run(study, options, make)


def with_drawn_conditions(study: Study, options: CompareOptions) -> Study:
    """The study of the drawn conditions, in the same folder. All are held out. Each has its own
    floor and refinements, because another condition may be chaotic."""
    source = _drawn(study, options)
    conditions = {
        f"blind{number + 1}": row for number, row in enumerate(source.rows(0, source.asked))
    }
    names = list(conditions)
    roles = {
        "agreement.fitted": [],
        "agreement.held_out": names,
        "agreement.floor": names,
        "agreement.refined": names,
    }
    return replace(study, scene=study.scene.replace({"conditions": conditions, **roles}), only=())


def _drawn(study: Study, options: CompareOptions) -> Drawn:
    return Drawn(
        uncertainty.load(
            uncertainty.chosen(options.vary, study.scene),
            study.scene,
            cases=options.cases or CASES,
            seed=seed_of(study, options),
            sampling="random",
        )
    )


def seed_of(study: Study, options: CompareOptions) -> int:
    """The seed of the draws."""
    return (
        options.seed
        if options.seed is not None
        else int(content_hash(sources.digest(*_CODE), study.scene.hash)[:12], 16)
    )


def _inputs(study: Study, options: CompareOptions) -> list:
    conditions = with_drawn_conditions(study, options).scene.conditions
    return [conditions, calibrate.constants(study), asdict(verdicts.gates(study.scene))]


STAGE = Stage(NAME, __name__, options=CompareOptions, inputs=_inputs, result=Blind)
