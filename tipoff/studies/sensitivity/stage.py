"""Stage ``sensitivity``: how much the answer depends on numbers nobody knows exactly. Contact
constants moved one at a time, as in Table 2 of the paper, and Sobol' indices over everything a file
calls uncertain, which the paper could not afford."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff.lowfi.ensemble.rows import Listed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.models import COMPLIANT, SPRINGS
from tipoff.scenes.faults import Fault, SceneError
from tipoff.studies import published
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.study import Study, StudyError
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.render.chart import to_files
from tipoff.studies.sensitivity import contact_table, indices, tolerances
from tipoff.studies.sensitivity import page as drawing

NAME = "sensitivity"
_HALVINGS = 3  # smaller runs beside the whole one, for convergence
_FINE = Numerics().relative_tolerance  # deviations of a thousandth are asked of a table


@dataclass(frozen=True)
class Options:
    """What ``tipoff sensitivity`` is given beside the scene: a file of tolerances or None for
    ``tolerances.DEFAULT``, base points (a power of two), a seed, the name of a model, None for the
    default."""

    vary: str | None = None
    points: int = 1024
    seed: int = 1
    model: str | None = None


def run(study: Study, options: Options = Options()) -> dict:
    """``tables`` like the paper's Table 2, ``sobol`` with indices by quantity, and ``summary`` in
    words.

    Raises SceneError for bad input, before anything runs, and StudyError where too few cases
    settle.
    """
    _require(study, options)

    def make() -> tuple[dict, list[Path]]:
        model = population.surrogate(study, options.model)
        found = {
            "asked": STAGE.plain(options),
            **population.answering(study, model),
            "citation": published.CITATION,
            "tables": _tables(study, model, options),
            "paper": _paper(),
            "sobol": _sobol(study, model, options),
        }
        found["summary"] = summary(found)
        files = [
            path
            for picture, _ in drawing.pictures(found)
            for path in to_files(picture, study.path("figures"))
        ]
        return found, files

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


def _tables(study: Study, model: Surrogate, options: Options) -> list[dict]:
    """One table about the constants of the surrogate, and one about the scene's own where a
    calibration changed them."""
    if model.scene.contact is None:
        return []
    titled = [(model.words, model)]
    if model.name == SPRINGS and model.scene.contact != study.scene.contact:
        # A law stands on the same rigid walls whatever its constants are: where warm rails have
        # moved them to.
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


def _sobol(study: Study, model: Surrogate, options: Options) -> dict:
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
            f"only {whole.sum()} of {options.points} base points settled in each of their "
            f"{inputs + 2} cases: too few "
            "to say anything of all; see the statuses in the store"
        )
    return {
        "inputs": [_described(item) for item in spread.inputs],
        "left_out": spread.left_out,
        "base_points": options.points,
        "used": int(whole.sum()),
        "cases": found.counts,
        "not_settled": int((~found.settled).sum()),
        "store": found.store,
        "quantities": [_quantity(item, found, inputs, options) for item in answers.ALL],
    }


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
    """Spread and indices of one quantity, those of the first parts of the points too."""
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


def summary(found: dict) -> list[str]:
    """What the study says, one line each."""
    paper = found["paper"]["largest"]
    lines = [population.model_line(found)]
    lines += [
        f"{table['title']}: moved one at a time, {_most(table['largest'])}; 1 um of clearance: "
        f"{_most(table['largest_clearance'])}"
        for table in found["tables"]
    ]
    lines += [
        f"{table['title']}, every quantity moves by up to: "
        + ", ".join(
            f"{item.label} {table['most_moved'][item.name]:.3g} {item.unit}" for item in answers.ALL
        )
        for table in found["tables"]
        if table["most_moved"]
    ]
    lines += [f"the paper's Table 2: {_most(paper)}"] if found["tables"] else []
    sobol = found["sobol"]
    lines.append(
        f"{sobol['cases']['asked']:,} cases of {len(sobol['inputs'])} inputs, "
        f"{sobol['not_settled']:,} did not settle; "
        f"{sobol['used']:,} of {sobol['base_points']:,} base points used"
    )
    for item in sobol["quantities"]:
        if item["indices"]:
            order = np.argsort(item["indices"]["total"])[::-1][:3]
            most = ", ".join(
                f"{sobol['inputs'][n]['key']} {item['indices']['total'][n]:.2f}" for n in order
            )
            lines.append(f"{item['label']}: sd {item['sd']:.3g} {item['unit']}; total index {most}")
    return lines


def _most(largest: dict) -> str:
    def shown(values, text):
        return ", ".join("-" if value is None else text.format(value) for value in values)

    relative = [None if value is None else 100.0 * value for value in largest["relative"]]
    return (
        f"rates about x, y, z move by up to {shown(largest['absolute_deg_s'], '{:.3g}')} deg/s, "
        f"{shown(relative, '{:.3g}')} %"
    )
