"""Stage ``flight``: flight of the payload after its exit, for every condition and for many cases
with random errors."""

from pathlib import Path

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import write_netcdf
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import halving, uncertainty
from tipoff.scenes.effects.registry import body_forces
from tipoff.scenes.variation import Variations
from tipoff.studies.flight import bodies, curves, flown, summary
from tipoff.studies.flight.options import FlightOptions
from tipoff.studies.flight.results import Condition, Curves, Flight
from tipoff.studies.populations import population
from tipoff.studies.populations.population import Population
from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted

NAME = "flight"


def run(study: Study, options: FlightOptions = FlightOptions()) -> Made[Flight]:
    """The flight after the exit. Raises SceneError for a scene without ``[flight]``."""
    _require(study)
    changed = {} if options.cases is None else {"cases": options.cases}
    vary = uncertainty.chosen(options.vary, study.scene)
    drawn = Drawn(uncertainty.load(vary, study.scene, **changed))
    if wrong := [key for key in drawn.keys if key.split(".")[0] == "flight"]:
        expected = "a key of the ejection: a flight is the same for all cases"
        raise SceneError([Fault(vary, f"vary.{key}", "a distribution", expected) for key in wrong])

    def make() -> tuple[Flight, list[Path]]:
        from tipoff.studies.flight import page
        from tipoff.studies.render.document import with_figures

        rows, shapes, single, exits = _conditions(study, options)
        whole = population.run(study, NAME, population.surrogate(study, options.model), drawn)
        many, left = _cases(study, whole, drawn)
        data = study.path(f"{NAME}.nc")
        names = [row.condition for row in rows if row.flown]
        write_netcdf(data, summary.dataset(names, single, exits, many, left))
        found = Flight(
            **population.answering(study, whole.model),
            scene=study.scene.name,
            errors=vary,
            sizes=halving.sizes(drawn.uncertainty),
            flight=summary.orbit(study.scene),
            conditions=tuple(rows),
            curves=shapes,
            cases=summary.cases(many, whole, drawn.uncertainty),
            data=study.relative(data),
        )
        found, pictures = with_figures(found, page.figures, study.path("figures"))
        return found, [data, *pictures]

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: FlightOptions) -> list:
    """Tables of the flight and distributions. Raises SceneError if no flight is possible."""
    _require(study)
    tables = {
        name: scene.flight and scene.flight.model_dump(mode="json")
        for name, scene in study.conditions.items()
    }
    vary = uncertainty.chosen(options.vary, study.scene)
    varied = uncertainty.load(vary, study.scene).resolved()
    own = bodies.table_of(study.scene).model_dump(mode="json")
    return [own, tables, varied, study.settings.element_size]


STAGE = Stage(NAME, __name__, options=FlightOptions, inputs=_inputs, result=Flight)


def _require(study: Study) -> None:
    scenes = study.conditions | {study.scene.name: study.scene}
    expected = 'a table [flight], or --set flight.altitude="500 km" --set flight.range="100 m"'
    from_ground = (
        "a launch in orbit; after one from the ground, `tipoff run --export` hands the state at exit to a "
        "code of flight"
    )
    faults = [
        Fault(name, "flight", "nothing", from_ground if body_forces(scene) else expected)
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
    study: Study, options: FlightOptions
) -> tuple[list[Condition], list[Curves], flown.Flown | None, Columns | None]:
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
            bodies.table_of(study.conditions[name]).record(),
            bodies.bodies([study.conditions[name]]),
            bodies.start(exits[name]),
        )
        for name in settled
    }
    single = [flown.found(both) for both in pairs.values()]
    values = dict(zip(settled, single))
    rows = [
        Condition(
            name,
            ended[name].status,
            summary.row(values[name], exits[name], 0) if name in values else None,
        )
        for name in ended
    ]
    first = [name for name in study.scene.agreement.fitted if name in pairs] or settled
    shapes = [
        curves.of_condition(name, pairs[name], values[name]) for name in first[: curves.SHOWN]
    ]
    if not single:
        return rows, shapes, None, None
    together = bodies.of_outcomes([ended[name].outcome for name in settled])
    return rows, shapes, flown.joined(single), together


def _cases(study: Study, cases: Population, drawn: Drawn) -> tuple[flown.Flown, Columns]:
    """Flights of those ``cases`` of ``drawn`` that settled, and their exit states."""
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
            bodies.table_of(study.scene).record(), parted, bodies.start(left), board.callback(label)
        )
        board.finished(label, "flown")
    return many, left
