"""Stage ``tails``: the random errors of stage ``montecarlo``, checked and corrected by the reference.

The first cases of the population run through the finite-element reference. Their differences from the
surrogate are counted by the number of contacts, and correct the statistics of all cases
(``populations.control_variate``, ``populations.poststratified``)."""

from pathlib import Path
from typing import Any

from tipoff.faults import Fault, SceneError, together
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.derived import Derived
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.studies.agreement import verdicts
from tipoff.studies.populations import answers, exceedance, population, spread
from tipoff.studies.populations import draws as paired
from tipoff.studies.populations.draws import Draws
from tipoff.studies.populations.population import Population
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted
from validation.montecarlo import cases, control_variate, paired_statistics, rungs
from validation.montecarlo import stage as montecarlo
from validation.montecarlo.options import FEWEST_FINE, MontecarloOptions
from validation.montecarlo.paired_statistics import RATES, both_settled
from validation.montecarlo.results import Cost, Tails

NAME = "tails"
FEWEST = 10  # draws; fewer give no useful interval


def run(study: Study, options: MontecarloOptions) -> Made[Tails]:
    """Rates and tails, corrected by the reference.

    Raises SceneError for bad input, every fault listed, and StudyError where too few cases settle.
    """
    asked = options.population
    limits, source, count = checked(study, options)

    def make() -> tuple[Tails, list[Path]]:
        from tipoff.studies.render.document import with_figures
        from validation.montecarlo import tails_page

        whole = population.run(
            study,
            montecarlo.NAME,
            population.surrogate(study, asked.model).watched(asked.at),
            source,
        )
        model, rows = whole.model, source.rows(0, count)
        drawn = paired.run(study, model, rows, options.on_finer_mesh)
        both = both_settled(drawn, whole)
        if both.sum() < control_variate.FEWEST:
            settled = counted(int(both.sum()), "draw") if both.any() else "no draw"
            raise StudyError(
                f"{settled} of {count} settled in both models; at least "
                f"{control_variate.FEWEST} are needed"
            )
        gate = verdicts.gates(study.scene).settled_rate_error_deg_s
        by_settings = rungs.run(study, model, rows)
        made = Tails(
            **population.answering(study, model),
            asked=options,
            reading=cases.words(study.scene, asked),
            store=whole.store,
            cases=len(whole.settled),
            settled=int(whole.settled.sum()),
            draws=len(drawn.reference.exit_time),
            counts=columns.counts(drawn.reference.status),
            paired=int(both.sum()),
            lost=tuple(drawn.lost),
            confidence=spread.CONFIDENCE,
            element_size_m=study.settings.coarse_size,
            elements=drawn.elements,
            fine=len(drawn.fine.exit_time),
            fine_element_size_m=study.settings.element_size,
            fine_elements=drawn.fine_elements,
            gate_deg_s=gate,
            has_contact=model.scene.contact is not None,
            cost=_cost(drawn, whole, paired.seconds_per_case(model, rows)),
            errors=tuple(paired_statistics.errors(item, drawn, whole) for item in answers.ALL),
            contacts=tuple(paired_statistics.by_contacts(drawn, gate)),
            ladder=by_settings and paired_statistics.ladder(by_settings, drawn, gate),
            statistics=tuple(
                row for item in RATES for row in paired_statistics.statistics(item, drawn, whole)
            ),
            tails=tuple(
                paired_statistics.tail(limit, drawn.reference, whole.results) for limit in limits
            ),
            pairs=paired_statistics.pairs(drawn, whole),
        )
        return with_figures(made, tails_page.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: MontecarloOptions) -> Any:
    return montecarlo.inputs(study, options.population)


STAGE = Stage(NAME, __name__, options=MontecarloOptions, inputs=_inputs, result=Tails)


def checked(
    study: Study, options: MontecarloOptions
) -> tuple[list[exceedance.Limit], Derived | Drawn, int]:
    """Limits, cases, and the number of draws. Raises SceneError listing every fault."""
    asked = options.population
    return tuple(
        together(
            lambda: exceedance.limits(asked.limits),
            lambda: cases.source(study.scene, asked, asked.cases),
            lambda: _draws(options),
        )
    )


def _draws(options: MontecarloOptions) -> int:
    faults, draws = [], options.draws or 0
    if not FEWEST <= draws <= options.population.cases:
        expected = f"{FEWEST} to {options.population.cases:,}, the number of cases"
        faults.append(Fault("--reference", "value", f"{draws:,}", expected))
    if options.fine is not None and not FEWEST_FINE <= options.fine <= draws:
        expected = f"{FEWEST_FINE} to {draws:,}, the number of draws"
        faults.append(Fault("--finer", "value", f"{options.fine:,}", expected))
    if faults:
        raise SceneError(faults)
    return draws


def _cost(drawn: Draws, whole: Population, surrogate: float) -> Cost:
    """The costs, with ``surrogate`` the processor seconds of its case."""
    ratio = drawn.reference_cpu_s / surrogate
    return Cost(
        reference_cpu_s=drawn.reference_cpu_s,
        fine_cpu_s=drawn.fine_cpu_s,
        surrogate_cpu_s=surrogate,
        ratio=ratio,
        optimal=tuple(paired_statistics.optimal(item, drawn, whole, ratio) for item in RATES),
    )
