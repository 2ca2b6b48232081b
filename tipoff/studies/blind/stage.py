"""Stage ``blind``: agreement on conditions drawn at random after all constants are fixed.

Authors of a surrogate can see held-out conditions. These are drawn from distributions of errors;
the default seed is a digest of the sources and the scene, so any change of the code draws others.
"""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from tipoff import sources
from tipoff.files import content_hash
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.mechanics.models import SPRINGS
from tipoff.scenes import uncertainty
from tipoff.studies.agreement import refined, verdicts
from tipoff.studies.agreement import stage as compare
from tipoff.studies.agreement.verdicts import Context
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.study import Study, require_success

NAME = "blind"
_CODE = ("tipoff.highfi", "tipoff.lowfi", "tipoff.calibration")


@dataclass(frozen=True)
class Options:
    """``cases`` conditions from the distributions ``vary``; ``seed`` None: the digest of the code
    and the scene."""

    cases: int = 8
    vary: str = uncertainty.DEFAULT
    seed: int | None = None


def run(study: Study, options: Options = Options()) -> dict:
    """Rows of ``calibrated`` springs and of ``compliant`` contact, as in the agreement study, and the
    drawn conditions."""
    drawn = draw(study, options)
    compared = [
        compare.Candidate("calibrated", f"{SPRINGS}, calibrated", calibrate.load(study)),
        compare.compliant(drawn, drawn.conditions),
    ]

    def make() -> tuple[dict, list[Path]]:
        wanted = {name: drawn.highfi(name) for name in drawn.conditions}
        highfi = dict(zip(wanted, drawn.store.fill("highfi", list(wanted.values()))))
        require_success(highfi, "judge blind conditions")
        changes, floor, gates = (
            refined.refinements(drawn),
            compare.floors(drawn, "reference", drawn.coarse),
            verdicts.gates(study.scene),
        )
        rows = {}
        for candidate in compared:
            own = compare.floors(drawn, candidate.title, partial(candidate.request, drawn))
            rows[candidate.name] = compare.rows(
                drawn, candidate, highfi, Context([*floor, *own], changes, gates)
            )
        return {
            "asked": STAGE.plain(options),
            "seed": seed_of(study, options),
            "gates": gates,
            "converged_deg_s": verdicts.CONVERGED_DEG_S,
            "clearance_change_m": study.settings.clearance_change,
            "conditions": drawn.scene.conditions,
            **rows,
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
