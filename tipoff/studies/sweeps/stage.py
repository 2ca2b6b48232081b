"""Stage ``sweeps``: section 3 of the paper. Misalignment, thrust eccentricity and mass eccentricity
vary one at a time in size and direction. Results: the size at which the largest rate stops growing,
the walls that the payload touches, and both for a longer or shorter thrust."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.mechanics.instant import EXIT
from tipoff.mechanics.run_limits import EXIT_WINDOW
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.render.document import with_figures
from tipoff.studies.sensitivity.options import ANGLES, FEWEST_ANGLES, SensitivityOptions
from tipoff.studies.sweeps import burnout, factors, knee, sides
from tipoff.studies.sweeps import figures as drawing
from tipoff.studies.sweeps.factors import FACTORS, SHARES, Factor
from tipoff.studies.sweeps.results import Curve, Launch, Sides, Sweeps, Swept
from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

NAME = "sweeps"
JUDGED = (*answers.RATES, answers.TOTAL_RATE)  # quantities whose growth is judged
# the default tolerance of ensembles takes six steps over a long thrust without contact, and loses
# 0.5 % of the impulse
_TOLERANCE = 1e-4
_COARSER = 5  # directions of the ensemble for each direction of the maps of walls
# relative to the rate of a free payload; a larger difference is an effect of the rail
_DEPARTS = 0.05


def run(study: Study, options: SensitivityOptions = SensitivityOptions()) -> Made[Sweeps]:
    """Rates over the size of each error. Raises SceneError for bad input, before anything runs."""
    errors = _swept_errors(study, options)

    def make() -> tuple[Sweeps, list[Path]]:
        model = population.surrogate(study, options.model)
        alone = model._replace(scene=factors.alone(model.scene)).watched(options.at)
        launch, alone = _launch(study, alone, options, 1.0, burnout.exit_of(alone), errors)
        faces, touched = _sides(study, alone, options, errors)
        swept = tuple(replace(each, sides=own) for each, own in zip(launch.factors, touched))
        launches = [replace(launch, faces=faces, factors=swept)]
        if other := burnout.other_way(alone):
            launches.append(_launch(study, other[1], options, other[0], other[2], errors)[0])
        found = Sweeps(
            **population.answering(study, alone),
            asked=options,
            held={} if options.vary is None else factors.held(options.vary, study.scene),
            launches=tuple(launches),
        )
        return with_figures(found, drawing.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def _swept_errors(study: Study, options: SensitivityOptions) -> tuple[Factor, ...]:
    return FACTORS if options.vary is None else factors.of_file(options.vary, study.scene)


def _inputs(study: Study, options: SensitivityOptions) -> Any:
    """The errors of a file with their largest sizes, and those that are held; None without one."""
    if options.vary is None:
        return None
    return _swept_errors(study, options), factors.held(options.vary, study.scene)


STAGE = Stage(NAME, __name__, options=SensitivityOptions, inputs=_inputs, result=Sweeps)


def _launch(
    study: Study,
    model: Surrogate,
    options: SensitivityOptions,
    stretch: float,
    leaves: burnout.Exit | None,
    errors: tuple[Factor, ...],
) -> tuple[Launch, Surrogate]:
    """All cases of one surrogate in one ensemble: the results of each factor, and the surrogate
    with the rail modes of its cases."""
    directions = factors.angles(options.sweep or ANGLES)
    found = population.run(study, NAME, model, factors.cases(errors, directions), _TOLERANCE)
    count = len(SHARES) * len(directions)
    until = leaves.time + 0.5 * EXIT_WINDOW if leaves and model.instant.at == EXIT else None
    made = Launch(
        stretch=stretch,
        exit_s=leaves and leaves.time,
        share_after_exit=leaves and leaves.share_after,
        cases=found.counts,
        not_settled=int((~found.settled).sum()),
        store=found.store,
        factors=tuple(
            _swept(found, factor, directions, slice(place * count, (place + 1) * count), until)
            for place, factor in enumerate(errors)
        ),
    )
    return made, found.model


def _swept(
    found: Population, factor: Factor, directions: np.ndarray, part: slice, until: float | None
) -> Swept:
    """Results of one factor from its ``part`` of the cases; ``until`` (s): the end of the impulse of
    the free payload, None for the whole."""
    sizes, shape = factor.sizes, (len(factor.sizes), len(directions))
    values = {item.name: item.of(found.results)[part].reshape(shape) for item in answers.ALL}
    rows = factor.rows(sizes, directions)
    free = np.degrees(factors.free_rates(found.model.scene, rows, until)).reshape(*shape, 3)
    total, free_total = values[answers.TOTAL_RATE.name], np.linalg.norm(free, axis=2)
    departs = (abs(total - free_total) > _DEPARTS * free_total).any(axis=1)
    return Swept(
        name=factor.name,
        label=factor.label,
        unit=factor.unit,
        sizes=tuple(sizes.tolist()),
        angles_deg=tuple(np.degrees(directions).tolist()),
        values={name: tuple(map(_plain, table)) for name, table in values.items()},
        largest={name: _plain(knee.largest(abs(table))) for name, table in values.items()},
        free={
            item.name: _plain(abs(column).max(axis=1))
            for item, column in zip(JUDGED, [*np.moveaxis(free, 2, 0), free_total])
        },
        departs_from_free_at=float(sizes[departs.argmax()]) if departs.any() else None,
        growth={item.name: knee.growth(sizes, abs(values[item.name])) for item in JUDGED},
    )


def _sides(
    study: Study, model: Surrogate, options: SensitivityOptions, errors: tuple[Factor, ...]
) -> tuple[tuple[str, ...], list[Sides | None]]:
    """Names of the faces, and for each factor the face that touched first and the one with the
    largest impulse, on a coarser grid of directions."""
    if model.scene.contact is None:
        return (), [None] * len(errors)
    directions = factors.angles(max(FEWEST_ANGLES, (options.sweep or ANGLES) // _COARSER))
    rows = [row for factor in errors for row in factor.rows(factor.sizes, directions)]
    with Board("which walls", 1) as board:
        seen = sides.found(
            model, rows, study.settings.workers, board.callback(f"which walls, {len(rows)} cases")
        )
    shape = len(errors), len(SHARES), len(directions)
    names = sides.names(model.scene)
    faces = np.array([*names, ""])  # the last is for no face, -1
    return tuple(names), [
        Sides(
            angles_deg=tuple(np.degrees(directions).tolist()),
            first=tuple(map(tuple, first.tolist())),
            most=tuple(map(tuple, most.tolist())),
            jumps_deg_s=sides.jumps(faces[most], np.degrees(rate)),
        )
        for first, most, rate in zip(
            seen.first.reshape(shape), seen.most.reshape(shape), seen.rate.reshape(*shape, 3)
        )
    ]


def _plain(values: np.ndarray) -> Curve:
    """Values (n,) with six digits, None where a case did not settle."""
    return tuple(float(f"{value:.6g}") if np.isfinite(value) else None for value in values)
