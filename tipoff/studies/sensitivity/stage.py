"""Stage ``sensitivity``: how much the result depends on uncertain inputs. Contact constants are
changed one at a time, as in Table 2 of the paper; Sobol' indices cover all inputs of a file of
tolerances."""

from pathlib import Path

import numpy as np

from tipoff.lowfi.ensemble.rows import Listed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.models import COMPLIANT, SPRINGS
from tipoff.scenes.faults import Fault, SceneError
from tipoff.studies import published
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.render.document import with_figures
from tipoff.studies.sensitivity import contact_table, indices, tolerances
from tipoff.studies.sensitivity import page as drawing
from tipoff.studies.sensitivity.options import Options
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study, StudyError

NAME = "sensitivity"
_HALVINGS = 3  # parts of the points, each half of the next, for convergence
_FINE = Numerics().relative_tolerance  # the tables show changes of a thousandth


def run(study: Study, options: Options = Options()) -> dict:
    """``tables`` in the form of the paper's Table 2, and ``sobol`` with the indices of every
    quantity.

    Raises SceneError for bad input, before anything runs, and StudyError where the scene itself or
    too few cases settle.
    """
    _require(study, options)

    def make() -> tuple[dict, list[Path]]:
        asked = population.surrogate(study, options.model)
        population.require_settling(asked)
        sobol, model = _sobol(study, asked, options)
        found = {
            "asked": STAGE.plain(options),
            **population.answering(study, model),
            "citation": published.CITATION,
            "tables": tables(study, model, options),
            "paper": _paper(),
            "sobol": sobol,
        }
        return with_figures(found, drawing.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def _varied(study: Study, options: Options) -> str:
    return tolerances.digest(options.vary or tolerances.DEFAULT)


STAGE = Stage(NAME, __name__, Options, _varied)


def _require(study: Study, options: Options) -> None:
    faults = []
    if options.points < 2**_HALVINGS * 8 or options.points & (options.points - 1):
        faults.append(
            Fault(
                "--points", NAME, str(options.points), f"a power of two, {2**_HALVINGS * 8} or more"
            )
        )
    if options.seed < 1:
        faults.append(Fault("--seed", NAME, str(options.seed), "1 or more"))
    try:
        tolerances.load(options.vary or tolerances.DEFAULT, study.scene, options.model or COMPLIANT)
    except SceneError as error:
        faults += error.faults
    if faults:
        raise SceneError(faults)


def tables(study: Study, model: Surrogate, options: Options) -> list[dict]:
    """One table for the constants of the surrogate, and one for those of the scene where a
    calibration changed them."""
    if model.scene.contact is None:
        return []
    titled = [(model.words, model)]
    if model.name == SPRINGS and model.scene.contact != study.scene.contact:
        # The rigid walls are the same, displaced by the temperature of the rails.
        own = Surrogate(study.scene, None, model.compliance)
        titled.append((own.words, own))
    return [{"title": title, **_table(study, surrogate)} for title, surrogate in titled]


def _table(study: Study, model: Surrogate) -> dict:
    contact = model.scene.contact
    assert contact is not None  # or there was no table
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
    table = []
    for place, name in enumerate(names):
        part = slice(place * count, (place + 1) * count)
        others = {key: column[part] for key, column in values.items()}
        table += contact_table.rows(name or study.scene.name, changed, rates[part], others)
    return {
        "law": contact.law,
        "constants_si": contact.model_dump(mode="json", exclude={"law"}),
        "rows": table,
        "largest": contact_table.largest(table),
        "largest_clearance": contact_table.largest(table, ["clearance"]),
        "most_moved": contact_table.most_moved(table),
        "store": found.store,
    }


def _paper() -> dict:
    table = contact_table.of_paper()
    return {"rows": table, "largest": contact_table.largest(table)}


def _sobol(study: Study, model: Surrogate, options: Options) -> tuple[dict, Surrogate]:
    """The indices, and the surrogate with the modes of their cases."""
    spread = tolerances.load(options.vary or tolerances.DEFAULT, model.scene, model.name)
    inputs = len(spread.inputs)
    found = population.run(
        study,
        NAME,
        model,
        Listed(spread.rows(indices.points(options.points, inputs, options.seed))),
    )
    whole = indices.whole_blocks(found.settled, inputs)
    if whole.sum() < options.points // 2:
        raise StudyError(
            f"only {whole.sum()} of {options.points} base points settled in all of their "
            f"{inputs + 2} cases: too few for indices; the store has the status of each case"
        )
    made = {
        "inputs": [_described(item) for item in spread.inputs],
        "left_out": spread.left_out,
        "base_points": options.points,
        "used": int(whole.sum()),
        "cases": found.counts,
        "not_settled": int((~found.settled).sum()),
        "store": found.store,
        "quantities": [_quantity(item, found, inputs, options) for item in answers.ALL],
    }
    return made, found.model


def _described(item: tolerances.Input) -> dict:
    low, high = np.sort(item.values(np.array([0.025, 0.975])))
    return {
        "key": item.key,
        "unit": item.unit,
        "nominal": item.nominal,
        "low": float(low),
        "high": float(high),
        "factor": item.is_factor,
        "distribution": item.distribution.distribution,
        "provenance": item.distribution.provenance,
    }


def _quantity(item: answers.Quantity, found: Population, inputs: int, options: Options) -> dict:
    """Spread and indices of one quantity, and its indices from the first parts of the points."""
    values = item.of(found.results)
    sizes = [options.points >> halving for halving in range(_HALVINGS, -1, -1)]
    series = [
        indices.indices(values[: size * (inputs + 2)], inputs, options.seed) for size in sizes
    ]
    settled = values[np.isfinite(values)]
    return {
        "name": item.name,
        "label": item.label,
        "unit": item.unit,
        "mean": float(settled.mean()),
        "sd": float(settled.std()),
        "indices": _plain(series[-1]),
        "convergence": [
            {"base_points": size} | (_plain(one) or {}) for size, one in zip(sizes, series)
        ],
    }


def _plain(found: indices.Indices | None) -> dict | None:
    return found and {
        name: value.tolist() if isinstance(value, np.ndarray) else value
        for name, value in found._asdict().items()
    }
