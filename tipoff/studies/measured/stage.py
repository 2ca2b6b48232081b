"""Stage ``measured``: logs of drop tests and of launches, compared with simulated cases of the same launcher.

The simulated cases vary the inputs of the given distributions (default: those of the scene, else ``paper`` of the
catalogue). Cases of drop tests start at rest in free fall: ``studies.measured.judgement`` ranks each test among
them, and ``studies.measured.power`` gives the power of that comparison. Launches are compared by
``studies.measured.launch``.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np

from tipoff.faults import Fault, SceneError, together
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.mechanics.instant import MOST, SETTLED, Instant
from tipoff.scenes import halving, uncertainty
from tipoff.scenes.scene import Scene
from tipoff.studies.measured import analysis, judgement, power, sheet, signals
from tipoff.studies.measured.analysis import Drop
from tipoff.studies.measured.events import WINDOWS
from tipoff.studies.measured.launch import analysis as launch
from tipoff.studies.measured.launch import compared as launched
from tipoff.studies.measured.launch import prediction
from tipoff.studies.measured.launch.analysis import Launched
from tipoff.studies.measured.log import read
from tipoff.studies.measured.options import MeasuredOptions
from tipoff.studies.measured.reduction import COVERAGE
from tipoff.studies.measured.results import (
    Compared,
    Comparison,
    Curve,
    JudgedTest,
    Launch,
    Measurements,
    SimulatedCases,
    Together,
)
from tipoff.studies.populations import answers, population, spread
from tipoff.studies.populations.population import Population
from tipoff.units import duration
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError

NAME = "measured"
_LAUNCHES = "launches"
_INSTANT = Instant(SETTLED, "because a log is read over a window without thrust")
_FEWEST = 20  # fewest settled cases for a useful covariance
_SHOWN = 2000  # cases in the figure
_EVERY = 4  # curves of a result file hold every fourth sample
_AROUND = 0.12  # s before and after ignition, where they hold all samples


def run(study: Study, options: MeasuredOptions = MeasuredOptions()) -> Made[Measurements]:
    """Measured drops among predicted ones.

    Raises SceneError listing every fault of every log and of the distributions, StudyError if too
    few cases settle.
    """
    (drops, launches), drawn = together(
        lambda: analysed(options.logs or sheet.SAMPLES, _scene(study, options)),
        lambda: _drawn(study, options),
    )
    if options.logs:
        options = replace(options, logs=tuple(path.resolve() for path in options.logs))

    def make() -> tuple[Measurements, list[Path]]:
        from tipoff.studies.measured import page
        from tipoff.studies.render.document import with_figures

        model = population.surrogate(study, options.model, options.condition)
        files: list[Path] = []
        compared, data = Compared(simulated_logs=False), None
        rows: tuple[Launch, ...] = ()
        comparisons: tuple[Comparison, ...] = ()
        if drops:
            cases = population.run(study, NAME, model._replace(instant=_INSTANT), drawn)
            data = study.path(f"{NAME}.nc")
            signals.write(data, drops)
            files.append(data)
            compared = result(study, drops, cases, drawn.uncertainty.sampling == "random")
            model = cases.model
        if launches:
            predicted = prediction.run(study, _LAUNCHES, model, drawn, launches)
            rows, comparisons, written = launched.results(study, launches, predicted)
            files += written
            model = predicted.model
        found = Measurements(
            **vars(compared),
            **population.answering(study, model, options.condition),
            launches=rows,
            comparisons=comparisons,
            scene=study.scene.name,
            request=options,
            errors=_vary(study, options),
            sizes=halving.sizes(drawn.uncertainty),
            varied=uncertainty.Varied(**drawn.uncertainty.resolved()),
            data=None if data is None else study.relative(data),
        )
        found, pictures = with_figures(found, page.figures, study.path("figures"))
        return found, [*files, *pictures]

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: MeasuredOptions) -> list:
    """Content of the logs and of the distributions. Raises SceneError for a missing or invalid
    file."""
    digests = [_digest(path) for path in options.logs or sheet.SAMPLES]
    return [digests, _drawn(study, options).uncertainty.resolved()]


STAGE = Stage(
    NAME, __name__, options=MeasuredOptions, inputs=_inputs, field="request", result=Measurements
)


def _drawn(study: Study, options: MeasuredOptions) -> Drawn:
    return Drawn(
        uncertainty.load(_vary(study, options), _scene(study, options), cases=options.cases)
    )


def _vary(study: Study, options: MeasuredOptions) -> str:
    return uncertainty.chosen(options.vary, _scene(study, options))


def _scene(study: Study, options: MeasuredOptions) -> Scene:
    return study.condition(options.condition) if options.condition else study.scene


def _digest(path: Path) -> list[str]:
    """Digests of a sheet and of its CSV file."""
    files = (path, path.parent / sheet.load(path).file)
    try:
        return [hashlib.sha256(file.read_bytes()).hexdigest() for file in files]
    except OSError as error:
        raise SceneError([Fault(str(path), "file", str(error), "a readable CSV file")]) from error


def analysed(paths: Sequence[Path], scene: Scene) -> tuple[list[Drop], list[Launched]]:
    """Every drop test and every launch of ``scene`` under a unique name. Raises SceneError listing every fault of
    every log."""
    drops: list[Drop] = []
    launches: list[Launched] = []
    different = {path.resolve(): path for path in reversed(paths)}
    places = [path.resolve() for path in paths]
    faults = [
        Fault("LOG", str(path), "twice", "every test once")
        for place, path in different.items()
        if places.count(place) > 1
    ]
    for path, name in zip(paths, short_names(places)):
        try:
            sheet_, log = read(path)
            if isinstance(sheet_, sheet.Sheet):
                drops.append(analysis.drop_of(sheet_, log, str(path))._replace(name=name))
            else:
                launches.append(launch.analyse(sheet_, log, scene, str(path))._replace(name=name))
        except SceneError as error:
            faults += error.faults
    if faults:
        raise SceneError(list(dict.fromkeys(faults)))
    return drops, launches


def short_names(places: list[Path]) -> list[str]:
    """Names of the sheets without suffix, with as many parent folders as needed to be unique."""
    names = [place.stem for place in places]
    for depth in range(2, max(len(place.parts) for place in places)):
        names = [
            "/".join(place.with_suffix("").parts[-depth:]) if names.count(name) > 1 else name
            for place, name in zip(places, names)
        ]
    return names


def result(
    study: Study, drops: list[Drop], cases: Population, independent: bool = True
) -> Compared:
    """The drops compared with the cases; ``independent``: the cases are independent draws. Raises
    StudyError where too few cases settle."""
    settled = cases.settled
    if settled.sum() < _FEWEST:
        raise StudyError(
            f"only {settled.sum()} of {settled.size} simulated cases left the rail and settled; "
            f"at least {_FEWEST} are needed"
        )
    rates, exits = np.degrees(cases.results.rate[settled]), cases.results.exit_time[settled]
    pushed = pushed_on(cases.results.impulse_after_exit[settled])
    tests = tuple(
        _row(number, drop, rates, [*_doubts(study, drop, exits), *pushed])
        for number, drop in enumerate(drops)
    )
    return Compared(
        simulated_logs=all(row.simulated for row in tests),
        tests=tests,
        together=_together(tests, rates),
        regions=tuple(judgement.region(rates, pair) for pair in combinations(range(3), 2)),
        power=power.table(rates, len(tests)),
        cases=SimulatedCases(
            **cases.counts,
            settled=len(rates),
            quantiles={
                item.name: spread.quantiles(item.of(cases.results)[settled], bounded=independent)
                for item in answers.ALL
            },
            store=cases.store,
            shown_deg_s=_plain(rates[:_SHOWN].round(4)),
        ),
    )


def _row(number: int, drop: Drop, simulated: np.ndarray, doubts: list[str]) -> JudgedTest:
    """One test among simulated rates (n,3) deg/s."""
    found, events, sheet_, windows = drop.reduced, drop.events, drop.sheet, drop.sheet.windows
    change, uncertainty = np.degrees(found.change), np.degrees(found.combined)
    within = (simulated.min(axis=0) <= change) & (change <= simulated.max(axis=0))
    return JudgedTest(
        **vars(judgement.standing(simulated, change, uncertainty, number)),
        test=drop.name,
        simulated=sheet_.simulated,
        description=sheet_.description,
        notes=(*drop.notes, *doubts),
        channel_class=sheet_.channel_class,
        interval_s=float(drop.samples.time[1] - drop.samples.time[0]),
        release_s=events.release,
        ignition_s=events.ignition,
        events_given=events.given,
        windows_s={name: getattr(drop.spans, name) for name in WINDOWS},
        instant_s=drop.spans.instant,
        rest_deg_s=float(np.degrees(drop.unrest)),
        rest_limit_deg_s=float(np.degrees(windows.rest_rate)),
        rest_kept=bool(drop.unrest <= windows.rest_rate),
        before_deg_s=_plain(np.degrees(found.before)),
        after_deg_s=_plain(np.degrees(found.after)),
        change_deg_s=_plain(change),
        standard_uncertainty_deg_s=_plain(uncertainty),
        coverage_factor=_plain(found.factor),
        expanded_uncertainty_deg_s=_plain(found.factor * uncertainty),
        coverage=COVERAGE,
        budget_deg_s={name: _plain(np.degrees(part)) for name, part in found.parts.items()},
        noise_deg_s=_plain(np.degrees(found.noise)),
        correlation_samples=found.correlation,
        inside_range=_plain(within),
        curve=_curve(drop),
    )


def _plain(values: np.ndarray) -> tuple:
    """An array (n,) or (n,k) as tuples."""
    return tuple(tuple(each) if isinstance(each, list) else each for each in values.tolist())


def _curve(drop: Drop) -> Curve:
    """All samples near the ignition and every fourth elsewhere."""
    time = drop.samples.time - drop.events.ignition
    keep = (np.abs(time) < _AROUND) | (np.arange(time.size) % _EVERY == 0)
    return Curve(_plain(time[keep].round(6)), _plain(np.degrees(drop.filtered[keep]).round(4)))


def _together(tests: Sequence[JudgedTest], simulated: np.ndarray) -> Together:
    """p by distance and by spread, and the smaller after Bonferroni."""
    changes = np.array([row.change_deg_s for row in tests])
    uncertainty = np.array([row.standard_uncertainty_deg_s for row in tests])
    out = judgement.combined([row.p_distance for row in tests])
    apart = judgement.p_spread(simulated, changes, uncertainty)
    return Together(
        p_distance=out,
        p_spread=apart,
        p=min(1.0, 2.0 * min(out, apart)),
        smallest_p=1.0 / (len(simulated) + 1),
        inside_range=all(all(row.inside_range) for row in tests),
    )


def pushed_on(shares: np.ndarray) -> list[str]:
    """A sentence if the ``shares`` (n,) of the impulse after the exit are not small."""
    share = float(np.median(shares))
    if not share > MOST:
        return []
    return [
        f"{100.0 * share:.2g} % of the impulse comes after the exit: windows.exit must be the end of "
        "the thrust, because the settled rates of the cases are those after it"
    ]


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
            f"exit {duration(windows.exit, 4)} after ignition, in the simulated cases after "
            f"{duration(float(exits.min()), 4)} to {duration(float(exits.max()), 4)}"
        )
    return notes
