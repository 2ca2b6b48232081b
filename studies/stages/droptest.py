"""Stage ``droptest``: logs of drop tests against the distribution that the surrogate has for the same launcher.

The simulated cases vary what the catalogue's ``paper`` distributions vary, and start at rest in free fall. How a test sits among
them is told by ranks (``studies.droptest.judgement``), what that is worth by its power (``studies.droptest.power``).
"""

import hashlib
from pathlib import Path

import numpy as np

from lowfi.rows import Drawn
from scenes import uncertainty
from scenes.faults import Fault, SceneError
from studies.droptest import shipped
from studies.droptest.analysis import Drop, analyse
from studies.droptest.results import joint, summary, row_of
from studies.populations import population
from studies.populations.population import Population
from studies.store import SOURCES
from studies.study import Study, StudyError

NAME = "droptest"
CASES = 1000
_FEWEST = 20  # settled cases; a covariance of fewer says little
_SHOWN = 2000  # cases in the figure


def run(study: Study, logs: list[Path] | None = None, cases: int = CASES, walls: bool = False) -> dict:
    """``tests`` with their rates, budgets and standing, ``together``, ``power``, and ``summary`` in words.

    Raises SceneError listing every fault of every log, StudyError where too few cases settle.
    """
    drops, request = _analysed(logs or shipped.sheets()), {"cases": cases, "walls": walls}
    request["logs"] = [_digest(path, drop) for path, drop in zip(logs or shipped.sheets(), drops)]

    def make() -> tuple[dict, list[Path]]:
        from studies.report import droptest as page
        from studies.report.chart import to_files

        found = result(study, drops, _cases(study, cases, walls)) | {"request": request, "surrogate": _surrogate(study, walls)}
        found["summary"] = summary(study.scene.name, found)
        return found, [path for chart in page.charts(found) for path in to_files(chart, study.path("figures"))]

    return study.stage(NAME, _key(study, request), make)


def stored(study: Study) -> dict | None:
    """The result, if it was made from the present scene, code and settings: the report shows it and makes none."""
    return study.stored(NAME, lambda found: _key(study, found["request"]))


def _key(study: Study, request: dict) -> str:
    return study.key(SOURCES["calibrated"], NAME, request)


def _analysed(paths: list[Path]) -> list[Drop]:
    drops, different = [], list(dict.fromkeys(paths))
    faults = [Fault("LOG", str(path), "twice", "every test once") for path in different if paths.count(path) > 1]
    for path in different:
        try:
            drops.append(analyse(path))
        except SceneError as error:
            faults += error.faults
    if faults:
        raise SceneError(faults)
    return drops


def _digest(path: Path, drop: Drop) -> str:
    return hashlib.sha256(Path(path).read_bytes() + (Path(path).parent / drop.sheet.file).read_bytes()).hexdigest()


def _cases(study: Study, cases: int, walls: bool) -> Population:
    source = Drawn(uncertainty.load(uncertainty.DEFAULT, study.scene, cases=cases))
    return population.run(study, NAME, population.surrogate(study, walls), source)


def _surrogate(study: Study, walls: bool) -> str:
    return "without contact" if study.scene.contact is None else "on compliant walls" if walls else "calibrated"


def result(study: Study, drops: list[Drop], cases: Population) -> dict:
    """The drops among the cases, as plain values. Raises StudyError where too few cases settle."""
    settled = cases.settled
    if settled.sum() < _FEWEST:
        raise StudyError(f"only {settled.sum()} of {settled.size} simulated cases left the rail and settled: too few")
    rates = np.degrees(cases.results.rate[settled])
    tests = [row_of(number, drop, rates) for number, drop in enumerate(drops)]
    for row, drop in zip(tests, drops):
        row["notes"] += _doubts(study, drop, cases.results.exit_time[settled])
    return {"simulated_logs": all(drop.sheet.simulated for drop in drops), "tests": tests, **joint(tests, rates),
            "cases": {**cases.counts, "settled": int(settled.sum()), "outside_calibration": int(cases.outside.sum()),
                      "store": cases.store, "shown_deg_s": np.round(rates[:_SHOWN], 4).tolist()}}


def _doubts(study: Study, drop: Drop, exits: np.ndarray) -> list[str]:
    """What makes a test and the cases not quite the same thing, in words."""
    notes, ask = [], drop.sheet.windows
    if drop.sheet.scene not in (None, study.scene.name):
        notes.append(f"the log is of the scene {drop.sheet.scene}, the simulated cases of {study.scene.name}")
    if not exits.min() - 3.0 * ask.exit_uncertainty <= ask.exit <= exits.max() + 3.0 * ask.exit_uncertainty:
        notes.append(f"left its rail {1e3 * ask.exit:.4g} ms after ignition, the simulated cases after {1e3 * exits.min():.4g} to "
                     f"{1e3 * exits.max():.4g} ms")
    return notes
