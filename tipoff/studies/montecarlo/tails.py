"""Stage ``tails``: the random errors of stage ``montecarlo``, checked and corrected by the reference.

The first cases of the population run through the finite-element reference. Their differences from the
surrogate are counted by the number of contacts, and correct the statistics of all cases
(``populations.control_variate``, ``populations.poststratified``)."""

import math
from dataclasses import dataclass, field
from pathlib import Path

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.derived import Derived
from tipoff.scenes.faults import Fault, SceneError, together
from tipoff.studies.agreement import verdicts
from tipoff.studies.montecarlo import paired_statistics
from tipoff.studies.montecarlo import stage as montecarlo
from tipoff.studies.montecarlo.paired_statistics import RATES, both_settled
from tipoff.studies.populations import (
    answers,
    control_variate,
    exceedance,
    own_modes,
    population,
    random_factors,
    spread,
)
from tipoff.studies.populations import draws as paired
from tipoff.studies.populations.draws import Draws, Rows
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted

NAME = "tails"
FEWEST = 10  # draws; fewer have no useful interval
_FEWEST_FINE = 4
_SHARE_FINE = 0.1  # of the draws are on the finer mesh too


@dataclass(frozen=True)
class Options:
    """``draws`` of the reference, the first cases of the ``population``; ``fine`` of them also at
    half the element size (None: a tenth, at least four)."""

    draws: int = 60
    fine: int | None = None
    population: montecarlo.Options = field(default_factory=montecarlo.Options)

    @property
    def on_finer_mesh(self) -> int:
        """Number of draws on the finer mesh."""
        if self.fine is not None:
            return self.fine
        return max(_FEWEST_FINE, math.ceil(_SHARE_FINE * self.draws))


def run(study: Study, options: Options = Options()) -> dict:
    """Errors of the surrogate by axis, by number of ``contacts`` and by rail modes, ``own_modes``,
    where the rails have some; change by the ``mesh``, corrected ``statistics`` and ``tails``, and
    what they would cost without the surrogate.

    Raises SceneError for bad input, every fault listed, and StudyError where too few cases settle.
    """
    asked = options.population
    limits, source = checked(study, options)

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.montecarlo import tails_page
        from tipoff.studies.render.document import with_figures

        whole = population.run(
            study, montecarlo.NAME, population.surrogate(study, asked.model), source
        )
        model = whole.model
        rows = source.rows(0, options.draws)
        drawn = paired.run(study, model, rows, options.on_finer_mesh)
        both = both_settled(drawn, whole)
        if both.sum() < control_variate.FEWEST:
            settled = counted(int(both.sum()), "draw") if both.any() else "no draw"
            raise StudyError(
                f"{settled} of {options.draws} settled in both models; at least "
                f"{control_variate.FEWEST} are needed"
            )
        made = {
            "asked": STAGE.plain(options),
            "reading": asked.reading.words,
            **population.answering(study, model),
            **_facts(study, drawn, whole, model),
            "cost": _costs(drawn, whole, paired.seconds_per_case(model, rows)),
            "errors": [paired_statistics.errors(item, drawn, whole) for item in answers.ALL],
            "contacts": paired_statistics.by_contacts(drawn, _gate(study)),
            **_own_modes(study, model, rows, drawn),
            "statistics": [
                row for item in RATES for row in paired_statistics.of(item, drawn, whole)
            ],
            "tails": [
                paired_statistics.tail(limit, drawn.reference, whole.results) for limit in limits
            ],
            "pairs": paired_statistics.pairs(drawn, whole),
        }
        return with_figures(made, lambda found: [tails_page.figure(found)], study.path("figures"))

    return STAGE.run(study, options, make)


STAGE = Stage(NAME, __name__, Options, montecarlo.fitted)


def checked(study: Study, options: Options) -> tuple[list[exceedance.Limit], Derived]:
    """Limits and cases. Raises SceneError listing every fault."""
    asked = options.population
    limits, source, _ = together(
        lambda: exceedance.limits(asked.limits),
        lambda: random_factors.source(study.scene, asked.reading, asked.cases, asked.seed),
        lambda: _require_counts(options),
    )
    return limits, source


def _require_counts(options: Options) -> None:
    faults = []
    if not FEWEST <= options.draws <= options.population.cases:
        expected = f"{FEWEST} to {options.population.cases:,}, the number of cases"
        faults.append(Fault("--reference", "value", f"{options.draws:,}", expected))
    if options.fine is not None and not _FEWEST_FINE <= options.fine <= options.draws:
        expected = f"{_FEWEST_FINE} to {options.draws:,}, the number of draws"
        faults.append(Fault("--finer", "value", f"{options.fine:,}", expected))
    if faults:
        raise SceneError(faults)


def _own_modes(study: Study, model: Surrogate, rows: Rows, drawn: Draws) -> dict:
    """The draws by rail modes, ``own_modes``; empty where the rails have none."""
    found = own_modes.run(study, model, rows)
    if found is None:
        return {}
    return {"own_modes": paired_statistics.by_modes(found, drawn, _gate(study))}


def _facts(study: Study, drawn: Draws, whole: Population, model: Surrogate) -> dict:
    """What was run."""
    return {
        "store": whole.store,
        "cases": len(whole.settled),
        "settled": int(whole.settled.sum()),
        "draws": len(drawn.reference.exit_time),
        "counts": columns.counts(drawn.reference.status),
        "paired": int(both_settled(drawn, whole).sum()),
        "lost": drawn.lost,
        "confidence": spread.CONFIDENCE,
        "element_size_m": study.settings.coarse_size,
        "elements": drawn.elements,
        "fine": len(drawn.fine.exit_time),
        "fine_element_size_m": study.settings.element_size,
        "fine_elements": drawn.fine_elements,
        "gate_deg_s": _gate(study),
        "has_contact": model.scene.contact is not None,
    }


def _costs(drawn: Draws, whole: Population, surrogate: float) -> dict:
    """Processor seconds of a run of each model, their ``ratio``, and the ``optimal`` allocation of
    runs by rate."""
    ratio = drawn.reference_cpu_s / surrogate
    return {
        "reference_cpu_s": drawn.reference_cpu_s,
        "fine_cpu_s": drawn.fine_cpu_s,
        "surrogate_cpu_s": surrogate,
        "ratio": ratio,
        "optimal": [paired_statistics.optimal(item, drawn, whole, ratio) for item in RATES],
    }


def _gate(study: Study) -> float:
    """Limit of the error of a settled rate (deg/s)."""
    return verdicts.gates(study.scene).settled_rate_error_deg_s
