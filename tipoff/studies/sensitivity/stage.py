"""Stage ``sensitivity``: how much the result depends on uncertain inputs. Contact constants are
changed one at a time, as in Table 2 of the paper; Sobol' indices cover all inputs of a file of
tolerances."""

from pathlib import Path

import numpy as np

from tipoff.faults import together
from tipoff.lowfi.ensemble.rows import Listed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.render.document import with_figures
from tipoff.studies.sensitivity import contact_table, indices, tolerances
from tipoff.studies.sensitivity.contact_table import PerturbedRun
from tipoff.studies.sensitivity.options import HALVINGS, SensitivityOptions
from tipoff.studies.sensitivity.results import (
    Constants,
    Sensitivity,
    Shares,
    Sobol,
    Step,
    Varied,
)
from tipoff.workspace.options import require
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError

NAME = "sensitivity"
SEED = 1  # of the points and of the bootstrap
_FINE = Numerics().relative_tolerance  # the tables show relative changes of a thousandth


def run(study: Study, options: SensitivityOptions = SensitivityOptions()) -> Made[Sensitivity]:
    """What each input changes.

    Raises SceneError for bad input, before anything runs, and StudyError if the scene itself does
    not settle or too few cases do.
    """
    vary = options.vary or tolerances.DEFAULT
    together(
        lambda: require(options),
        lambda: tolerances.load(vary, study.scene, options.model or COMPLIANT),
    )

    def make() -> tuple[Sensitivity, list[Path]]:
        from tipoff.studies.sensitivity import page

        asked = population.surrogate(study, options.model)
        population.require_settling(asked)
        sobol, model = _sobol(study, asked.watched(options.at), options)
        found = Sensitivity(
            **population.answering(study, model),
            asked=options,
            tables=tuple(tables(study, model)),
            sobol=sobol,
        )
        return with_figures(found, page.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def _varied(study: Study, options: SensitivityOptions) -> str:
    return tolerances.digest(options.vary or tolerances.DEFAULT)


STAGE = Stage(NAME, __name__, options=SensitivityOptions, inputs=_varied, result=Sensitivity)


def tables(study: Study, model: Surrogate) -> list[Constants]:
    """A table for the constants of the surrogate, and one for the constants of the scene if a
    calibration changed them."""
    if model.scene.contact is None:
        return []
    shown = [model]
    if model.name == SPRINGS and model.scene.contact != study.scene.contact:
        # The rigid walls are the same, displaced by the temperature of the rails.
        shown.append(Surrogate(study.scene, None, model.compliance, instant=model.instant))
    return [_table(study, each) for each in shown]


def _table(study: Study, model: Surrogate) -> Constants:
    contact = model.scene.contact
    assert contact is not None  # otherwise there is no table
    changed = contact_table.changes(model.scene, model.name)
    names: list[str | None] = [*contact_table.conditions(study.scene)] or [None]
    rows = [
        (study.scene.conditions[name] if name else {}) | change.overrides
        for name in names
        for change in changed
    ]
    found = population.run(study, f"{NAME}-table", model, Listed(rows), _FINE)
    rates, count = np.degrees(found.results.rate), len(changed)
    values = {item.name: item.of(found.results) for item in answers.ALL}
    table: list[PerturbedRun] = []
    for place, name in enumerate(names):
        part = slice(place * count, (place + 1) * count)
        others = {key: column[part] for key, column in values.items()}
        table += contact_table.rows(name or study.scene.name, changed, rates[part], others)
    return Constants(
        title=model.words,
        law=contact.law,
        constants_si=contact.model_dump(mode="json", exclude={"law"}),
        rows=tuple(table),
        largest=contact_table.largest(table),
        largest_clearance=contact_table.largest(table, ["clearance"]),
        most_moved=contact_table.most_moved(table),
        store=found.store,
    )


def _sobol(study: Study, model: Surrogate, options: SensitivityOptions) -> tuple[Sobol, Surrogate]:
    """The indices, and the surrogate with the rail modes of the cases."""
    spread = tolerances.load(options.vary or tolerances.DEFAULT, model.scene, model.name)
    inputs = len(spread.inputs)
    points = indices.points(options.points, inputs, SEED)
    found = population.run(study, NAME, model, Listed(spread.rows(points)))
    whole = indices.whole_blocks(found.settled, inputs)
    if whole.sum() < options.points // 2:
        raise StudyError(
            f"only {whole.sum()} of {options.points} base points settled in all of their "
            f"{inputs + 2} cases: too few for indices; the store has the status of each case"
        )
    made = Sobol(
        inputs=tuple(map(_described, spread.inputs)),
        left_out=spread.left_out,
        base_points=options.points,
        used=int(whole.sum()),
        cases=found.counts,
        not_settled=int((~found.settled).sum()),
        store=found.store,
        quantities=tuple(_shares(item, found, inputs, options) for item in answers.ALL),
    )
    return made, found.model


def _described(item: tolerances.Input) -> Varied:
    low, high = np.sort(item.values(np.array([0.025, 0.975]))).tolist()
    return Varied(
        key=item.key,
        unit=item.unit,
        nominal=item.nominal,
        low=low,
        high=high,
        factor=item.is_factor,
        distribution=item.distribution.distribution,
        provenance=item.distribution.provenance,
    )


def _shares(
    item: answers.Quantity, found: Population, inputs: int, options: SensitivityOptions
) -> Shares:
    """Spread and indices of one quantity, and its indices from the first parts of the points."""
    values = item.of(found.results)
    sizes = [options.points >> halving for halving in range(HALVINGS, -1, -1)]
    series = [indices.indices(values[: size * (inputs + 2)], inputs, SEED) for size in sizes]
    settled = values[np.isfinite(values)]
    return Shares(
        **item.named,
        mean=float(settled.mean()),
        sd=float(settled.std()),
        indices=series[-1],
        first_sum_half_width=indices.sum_half_width(values, inputs, SEED),
        convergence=tuple(
            Step(base_points=size, **(vars(one) if one else {})) for size, one in zip(sizes, series)
        ),
    )
