"""Stage ``droptest``: logs of drop tests compared with simulated cases of the same launcher.

The simulated cases vary the inputs of the given distributions (default: ``paper`` of the catalogue)
and start at rest in free fall. ``studies.droptest.judgement`` ranks each test among them;
``studies.droptest.power`` gives the power of that comparison.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import uncertainty
from tipoff.scenes.faults import Fault, SceneError, together
from tipoff.scenes.scene import Scene
from tipoff.studies.droptest import sheet, signals
from tipoff.studies.droptest.analysis import Drop, analyse
from tipoff.studies.droptest.options import Options
from tipoff.studies.droptest.results import joint, quantiles, row_of
from tipoff.studies.populations import population
from tipoff.studies.populations.population import Population
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study, StudyError

NAME = "droptest"
CASES = 1000
_FEWEST = 20  # settled cases for a useful covariance
_SHOWN = 2000  # cases in the figure


def run(study: Study, options: Options = Options()) -> dict:
    """``tests`` with their rates, uncertainty budgets and ranks, ``together``, ``power``.

    Raises SceneError listing every fault of every log and of the distributions, StudyError where
    too few cases settle.
    """
    drops, drawn = together(
        lambda: analysed(options.logs or sheet.SAMPLES), lambda: _drawn(study, options)
    )
    if options.logs:
        options = replace(options, logs=tuple(path.resolve() for path in options.logs))

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.droptest import page
        from tipoff.studies.render.document import with_figures

        model = population.surrogate(study, options.model, options.condition)
        cases = population.run(study, NAME, model, drawn)
        found = result(study, drops, cases, drawn.uncertainty.sampling == "random")
        found |= {
            "request": STAGE.plain(options),
            **population.answering(study, cases.model, options.condition),
            "varied": drawn.uncertainty.resolved(),
        }
        data = study.path(f"{NAME}.nc")
        signals.write(data, drops)
        found, pictures = with_figures(found, page.figures, study.path("figures"))
        return found | {"data": study.relative(data)}, [data, *pictures]

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: Options) -> list:
    """Content of the logs and of the distributions. Raises SceneError for a missing or invalid
    file."""
    digests = [_digest(path) for path in options.logs or sheet.SAMPLES]
    return [digests, _drawn(study, options).uncertainty.resolved()]


STAGE = Stage(NAME, __name__, Options, _inputs, "request")


def _drawn(study: Study, options: Options) -> Drawn:
    seed = {} if options.seed is None else {"seed": options.seed}
    return Drawn(
        uncertainty.load(options.vary, _scene(study, options), cases=options.cases, **seed)
    )


def _scene(study: Study, options: Options) -> Scene:
    return study.condition(options.condition) if options.condition else study.scene


def _digest(path: Path) -> list[str]:
    """Digests of a sheet and of its CSV file."""
    files = (path, path.parent / sheet.load(path).file)
    try:
        return [hashlib.sha256(file.read_bytes()).hexdigest() for file in files]
    except OSError as error:
        raise SceneError([Fault(str(path), "file", str(error), "a readable CSV file")]) from error


def analysed(paths: Sequence[Path]) -> list[Drop]:
    """Every log under a unique name. Raises SceneError listing every fault of every log."""
    drops, different = [], {path.resolve(): path for path in reversed(paths)}
    places = [path.resolve() for path in paths]
    faults = [
        Fault("LOG", str(path), "twice", "every test once")
        for place, path in different.items()
        if places.count(place) > 1
    ]
    for path, name in zip(paths, short_names(places)):
        try:
            drops.append(analyse(path)._replace(name=name))
        except SceneError as error:
            faults += error.faults
    if faults:
        raise SceneError(list(dict.fromkeys(faults)))
    return drops


def short_names(places: list[Path]) -> list[str]:
    """Names of the sheets without suffix, with as many parent folders as make them unique."""
    names = [place.stem for place in places]
    for depth in range(2, max(len(place.parts) for place in places)):
        names = [
            "/".join(place.with_suffix("").parts[-depth:]) if names.count(name) > 1 else name
            for place, name in zip(places, names)
        ]
    return names


def result(study: Study, drops: list[Drop], cases: Population, independent: bool = True) -> dict:
    """The drops compared with the cases, as plain values; ``independent``: the cases are
    independent draws. Raises StudyError where too few cases settle."""
    settled = cases.settled
    if settled.sum() < _FEWEST:
        raise StudyError(
            f"only {settled.sum()} of {settled.size} simulated cases left the rail and settled; "
            f"at least {_FEWEST} are needed"
        )
    rates = np.degrees(cases.results.rate[settled])
    tests = [row_of(number, drop, rates) for number, drop in enumerate(drops)]
    for row, drop in zip(tests, drops):
        row["notes"] += _doubts(study, drop, cases.results.exit_time[settled])
    return {
        "simulated_logs": all(drop.sheet.simulated for drop in drops),
        "tests": tests,
        **joint(tests, rates),
        "cases": {
            **cases.counts,
            "settled": int(settled.sum()),
            "quantiles": quantiles(cases.results, settled, independent),
            "store": cases.store,
            "shown_deg_s": np.round(rates[:_SHOWN], 4).tolist(),
        },
    }


def _doubts(study: Study, drop: Drop, exits: np.ndarray) -> list[str]:
    """Differences between the conditions of a test and of the cases, as sentences."""
    notes, windows = [], drop.sheet.windows
    if drop.sheet.scene not in (None, study.scene.name):
        notes.append(
            f"the log belongs to scene {drop.sheet.scene}, the simulated cases to "
            f"{study.scene.name}"
        )
    if (
        not exits.min() - 3.0 * windows.exit_uncertainty
        <= windows.exit
        <= exits.max() + 3.0 * windows.exit_uncertainty
    ):
        notes.append(
            f"exit {1e3 * windows.exit:.4g} ms after ignition, in the simulated cases after "
            f"{1e3 * exits.min():.4g} to {1e3 * exits.max():.4g} ms"
        )
    return notes
