"""Stage ``blind``: agreement on conditions drawn at random after all constants are fixed.

Authors of a surrogate can see held-out conditions. These are drawn from distributions of errors;
the default seed is a digest of the sources and the scene, so any change of the code draws others.
They are judged as the chosen ones are: as curves, or as distributions where no single run can judge.
"""

from dataclasses import asdict, replace
from pathlib import Path

from tipoff import sources
from tipoff.files import content_hash
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import uncertainty
from tipoff.studies.agreement import judging, verdicts
from tipoff.studies.agreement.candidates import calibrated, compliant
from tipoff.studies.blind.options import Options
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study

NAME = "blind"
_CODE = ("tipoff.highfi", "tipoff.lowfi", "tipoff.calibration")


def run(study: Study, options: Options = Options()) -> dict:
    """Rows of ``calibrated`` springs and of ``compliant`` contact, ``growth`` of a 1 um disturbance
    and ``distributions``, as in the agreement study, and the drawn conditions."""
    drawn = draw(study, options)
    compared = [calibrated(study), compliant(drawn, drawn.conditions)]

    def make() -> tuple[dict, list[Path]]:
        curves = judging.as_curves(drawn, compared, "judge blind conditions")
        draws = options.neighbours or study.settings.neighbours
        found = judging.judge(drawn, compared, curves, draws)
        return {
            "asked": STAGE.plain(options),
            "seed": seed_of(study, options),
            "gates": verdicts.gates(study.scene),
            "converged_deg_s": verdicts.CONVERGED_DEG_S,
            "clearance_change_m": study.settings.clearance_change,
            "conditions": drawn.scene.conditions,
            **found.rows,
            "growth": [asdict(item) for item in found.growths],
            "distributions": found.distributions,
        }, []

    return STAGE.run(study, options, make)


def draw(study: Study, options: Options) -> Study:
    """The study of the drawn conditions, in the same folder: all held out, each with its own floor
    and refinements, because the uncertainty of another, possibly chaotic, condition does not
    apply."""
    source = Drawn(
        uncertainty.load(
            options.vary,
            study.scene,
            cases=options.cases,
            seed=seed_of(study, options),
            sampling="random",
        )
    )
    conditions = {
        f"blind{number + 1}": row for number, row in enumerate(source.rows(0, options.cases))
    }
    names = list(conditions)
    roles = {
        "agreement.fitted": [],
        "agreement.held_out": names,
        "agreement.floor": names,
        "agreement.refined": names,
    }
    return replace(study, scene=study.scene.replace({"conditions": conditions, **roles}), only=())


def seed_of(study: Study, options: Options) -> int:
    """The seed of the draws."""
    return (
        options.seed
        if options.seed is not None
        else int(content_hash(sources.digest(*_CODE), study.scene.hash)[:12], 16)
    )


def _inputs(study: Study, options: Options) -> list:
    conditions = draw(study, options).scene.conditions
    return [conditions, calibrate.constants(study), verdicts.gates(study.scene)]


STAGE = Stage(NAME, __name__, Options, _inputs)
