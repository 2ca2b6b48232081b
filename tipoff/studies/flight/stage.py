"""Stage ``flight``: flight of the payload after its exit, for every condition and for many cases
with random errors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff.files import write_netcdf
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import uncertainty
from tipoff.scenes.effects.flight import FlightTable
from tipoff.scenes.effects.registry import body_forces
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.scene import Scene
from tipoff.scenes.variation import Variations
from tipoff.studies.flight import bodies, curves, flown, summary
from tipoff.studies.populations import population
from tipoff.studies.populations.population import Population
from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted

NAME = "flight"


@dataclass(frozen=True)
class Options:
    """Options of ``tipoff flight``: ``vary``, the distributions; number of ``cases`` and their
    ``seed``, None: those of the file; ``model`` by name, None: the default."""

    vary: str = uncertainty.DEFAULT
    cases: int | None = None
    seed: int | None = None
    model: str | None = None


def run(study: Study, options: Options = Options()) -> dict:
    """``conditions``, rows as ``studies.flight.summary`` has them; ``cases``, their distributions;
    ``curves`` of the first conditions. Raises SceneError for a scene without ``[flight]``."""
    _require(study)
    changed = {
        name: value
        for name, value in (("cases", options.cases), ("seed", options.seed))
        if value is not None
    }
    drawn = Drawn(uncertainty.load(options.vary, study.scene, **changed))
    if wrong := [key for key in drawn.keys if key.split(".")[0] == "flight"]:
        expected = "a key of the ejection: a flight is the same for all cases"
        raise SceneError(
            [Fault(options.vary, f"vary.{key}", "a distribution", expected) for key in wrong]
        )

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.flight import page
        from tipoff.studies.render.document import with_figures

        rows, shapes, single, exits = _conditions(study, options)
        whole = population.run(study, NAME, population.surrogate(study, options.model), drawn)
        cases, many, left = _cases(study, whole, drawn)
        found = {
            "asked": STAGE.plain(options),
            **population.answering(study, whole.model),
            "flight": summary.orbit(study.scene),
            "conditions": rows,
            "curves": shapes,
            "cases": cases,
        }
        data = study.path(f"{NAME}.nc")
        labelled = summary.dataset(
            [row["condition"] for row in rows if row["flown"]], single, exits, many, left
        )
        write_netcdf(data, labelled)
        found, pictures = with_figures(found, page.figures, study.path("figures"))
        return found | {"data": study.relative(data)}, [data, *pictures]

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: Options) -> list:
    """Tables of the flight and distributions. Raises SceneError where no flight is possible."""
    _require(study)
    tables = {
        name: scene.flight and scene.flight.model_dump(mode="json")
        for name, scene in study.conditions.items()
    }
    varied = uncertainty.load(options.vary, study.scene).resolved()
    own = _flight(study.scene).model_dump(mode="json")
    return [own, tables, varied, study.settings.element_size]


STAGE = Stage(NAME, __name__, Options, _inputs)


def _flight(scene: Scene) -> FlightTable:
    assert scene.flight is not None  # which is required of every scene
    return scene.flight


def _require(study: Study) -> None:
    scenes = study.conditions | {study.scene.name: study.scene}
    expected = 'a table [flight], or --set flight.altitude="500 km" --set flight.range="100 m"'
    faults = [
        Fault(name, "flight", "nothing", expected)
        for name, scene in scenes.items()
        if scene.flight is None
    ]
    faults += [
        Fault(name, key, "a table", "none beside [flight]: scene axes in orbit fall freely")
        for name, scene in scenes.items()
        if scene.flight
        for key in body_forces(scene)
    ]
    if faults:
        raise SceneError(faults)


def _conditions(
    study: Study, options: Options
) -> tuple[list[dict], list[dict], flown.Flown | None, bodies.Exits | None]:
    """A row for every condition, curves of the first that settled, flights of all that settled, and
    their outcomes as arrays."""
    runs = []
    for name in study.conditions:
        model = population.surrogate(study, options.model, name)
        runs.append(study.lowfi(name, model.calibration, compliance=model.compliance))
    ended = dict(zip(study.conditions, study.store.fill(NAME, runs)))
    settled = [name for name, found in ended.items() if found.outcome.rate is not None]
    exits = {name: bodies.of_outcomes([ended[name].outcome]) for name in settled}
    pairs = {
        name: flown.pair(
            _flight(study.conditions[name]).record(),
            bodies.bodies([study.conditions[name]]),
            bodies.start(exits[name]),
        )
        for name in settled
    }
    single = [flown.found(both) for both in pairs.values()]
    values = dict(zip(settled, single))
    rows = [
        {
            "condition": name,
            "status": ended[name].status,
            "flown": summary.row(values[name], exits[name], 0) if name in values else None,
        }
        for name in ended
    ]
    first = [name for name in study.scene.agreement.fitted if name in pairs] or settled
    shapes = [
        {"condition": name, **curves.of(pairs[name], values[name])}
        for name in first[: curves.SHOWN]
    ]
    return (
        rows,
        shapes,
        *(
            (flown.joined(single), bodies.of_outcomes([ended[name].outcome for name in settled]))
            if single
            else (None, None)
        ),
    )


def _cases(study: Study, cases: Population, drawn: Drawn) -> tuple[dict, flown.Flown, Columns]:
    """Distributions over the ``cases`` of ``drawn``, flights of those that settled, and their exit
    states."""
    which = np.flatnonzero(cases.settled)
    if not len(which):
        raise StudyError(
            f"none of {drawn.asked:,} cases left the rail and settled; store {cases.store}"
        )
    variations, rows = Variations(cases.model.scene), drawn.rows(0, drawn.asked)
    parted = bodies.bodies(variations.of(rows[number]) for number in which)
    with Board(NAME, 1) as board:
        label = counted(len(which), "flight")
        left = Columns(*(part[which] for part in cases.results))
        many = flown.fly(
            _flight(study.scene).record(), parted, bodies.start(left), board.callback(label)
        )
        board.finished(label, "flown")
    return summary.cases(many, cases, drawn.uncertainty), many, left
