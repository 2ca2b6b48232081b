"""Stage ``cost``: error of the settled rates over wall time, both fidelities on one condition.

Errors are relative to the finest finite-element mesh. Its uncertainty is the band below which an error
cannot be distinguished from zero; a smaller error counts as the band in the Pareto front. Every run is
timed alone on the machine. The time-integration error of a surrogate is relative to its tightest
tolerance with the same rail modes; the rest of its error is the error of the model.

``cost.json`` is the list of points for other tools, ``cost_study.json`` the whole result.
"""

import json
import math
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from tipoff.comparison.metrics import compare
from tipoff.files import write_text
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.mechanics.rail_compliance import MODES as ALL_MODES
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement import refinement, verdicts
from tipoff.studies.agreement.candidates import Candidate, candidates
from tipoff.studies.agreement.verdicts import Context
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.cost import choice
from tipoff.studies.cost.choice import Trusted
from tipoff.studies.cost.results import BY_MODES, BY_PATTERNS, Cost, Match, Point
from tipoff.workspace import machine
from tipoff.workspace.compiling import warm_up
from tipoff.workspace.progress import Board
from tipoff.workspace.run import Run, execute, with_modes_of
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study
from tipoff.workspace.timing import timed
from tipoff.workspace.words import counted

MODES = (0, 1, 2, 4, 8)  # modes of each rail; those of the agreement study have their own point
DEGREES = 2, 5  # of the patterns, beside the default, with all modes
STIFFNESS_ALONG = f"{COMPLIANT}, mean pressure of each face by itself"
NAME, POINTS = "cost_study", "cost.json"


def run(study: Study) -> Made[Cost]:
    """Errors and wall times."""
    name = condition(study)
    compared = surrogates(study)

    def make() -> tuple[Cost, list[Path]]:
        finest, band, points = _reference_points(study, name)
        for candidate in compared:
            points += surrogate_points(study, name, candidate, finest, study.settings.tolerances)
        points += points_by_modes(study, name, compared[-1], finest)
        points += points_by_patterns(study, name, compared[-1], finest)
        path, points = study.path(POINTS), marked(points, band)
        write_text(path, json.dumps(list(map(asdict, points)), indent=1, allow_nan=False) + "\n")
        found = Cost(
            condition=name,
            scene_hash=study.scene.hash,
            band_deg_s=band,
            points=tuple(points),
            matched=tuple(matched(points)),
            hardware=machine.describe(),
        )
        return found, [path]

    return STAGE.run(study, None, make)


def _inputs(study: Study, _: None) -> list:
    return [condition(study), calibrate.constants(study)]


STAGE = Stage(NAME, __name__, inputs=_inputs, result=Cost)
stored = STAGE.stored


def condition(study: Study) -> str:
    """The condition of the study: the first refined one, or the first fitted one."""
    return (study.scene.agreement.refined or study.fitted())[0]


def surrogates(study: Study, conditions: Iterable[str] | None = None) -> list[Candidate]:
    """The surrogates of the agreement study for ``conditions`` (default: all), and one with part of
    the rail compliance."""
    plain, calibrated, compliant, modal = candidates(study, conditions)
    along = {
        name: whole and whole.restricted(1, coupled=False)
        for name, whole in compliant.compliance.items()
    }
    return [
        plain,
        calibrated,
        compliant._replace(name="along", title=STIFFNESS_ALONG, compliance=along),
        compliant,
        modal,
    ]


def _reference_points(study: Study, name: str) -> tuple[Trajectory, float | None, list[Point]]:
    settings = study.settings
    sizes = (2.0 * settings.coarse_size, settings.coarse_size, settings.element_size)
    wanted = refinement.meshes(study, name, sizes)  # as in the agreement study
    coarsest, coarse, finest = study.store.fill("cost, meshes", wanted)
    band = Context(
        [], refinement.refinements(study, [name]), verdicts.gates(study.scene)
    ).uncertainty(name)[0]
    points = [
        Point(
            model=FINITE_ELEMENTS,
            rung="highfi",
            setting=size,
            modes=None,
            numerics=f"{1e3 * size:g} mm, {found.cost['elements']:,} elements",
            error_deg_s=None if found is finest else _error(finest, found),
            curve_error=None if found is finest else _curve_error(finest, found),
            integration_error_deg_s=None,
            wall_s=wall,
            status=found.status,
            reference=found is finest and found.outcome.rate is not None,
        )
        for size, found, wall in zip(sizes, (coarsest, coarse, finest), _wall_times(wanted))
    ]
    return finest, band, points


def _wall_times(runs: list[Run]) -> list[float]:
    """Wall time (s) of each run alone; the runs of the store may have shared the machine."""
    found = []
    with Board("cost, times", len(runs)) as board:
        for run in runs:
            warm_up(run)
            found.append(timed(run, board.callback(run.label))[1])
            board.finished(run.label, f"{found[-1]:.3g} s")
    return found


def _error(finest: Trajectory, found: Trajectory) -> float | None:
    """Error of the settled rates against the finest mesh (deg/s)."""
    return verdicts.settled_change(finest, found)


def _curve_error(finest: Trajectory, found: Trajectory) -> float | None:
    """Error of the curves against the finest mesh (rate L2, relative)."""
    return compare(finest, found).rate_relative_l2


def points_by_modes(
    study: Study, name: str, candidate: Candidate, finest: Trajectory
) -> list[Point]:
    """Points with other numbers of modes than the ``candidate`` has, at the tolerance of all other
    studies; errors against the ``finest`` mesh."""
    return [
        replace(point, model=BY_MODES, numerics=counted(count, "mode"), modes=count)
        for count in MODES
        if count != candidate.modes
        for point in surrogate_points(
            study, name, candidate._replace(modes=count), finest, [Numerics().relative_tolerance]
        )
    ]


def points_by_patterns(
    study: Study, name: str, candidate: Candidate, finest: Trajectory
) -> list[Point]:
    """Points with patterns of other degrees and all modes of the rail compliance: the most accurate
    that the surrogate is; errors against the ``finest`` mesh."""
    scene, found = study.condition(name), []
    for degree in DEGREES if scene.contact is not None else ():
        walls = study.rail_compliance(scene, degree=degree)
        better = candidate._replace(modes=ALL_MODES, compliance={name: walls})
        numerics = f"degree {degree}, {ALL_MODES} modes"
        tolerance = [Numerics().relative_tolerance]
        found += [
            replace(point, model=BY_PATTERNS, numerics=numerics, modes=ALL_MODES, degree=degree)
            for point in surrogate_points(study, name, better, finest, tolerance)
        ]
    return found


def surrogate_points(
    study: Study,
    name: str,
    candidate: Candidate,
    finest: Trajectory,
    tolerances: Iterable[float],
) -> list[Point]:
    """Points of one surrogate, the loosest of the ``tolerances`` first; errors against the ``finest``
    mesh."""
    tolerances = sorted(tolerances)
    wanted = [
        candidate.request(study, name, relative_tolerance=tolerance) for tolerance in tolerances
    ]
    warm_up(wanted[0])
    measured = [[timed(run) for _ in range(study.settings.lowfi_repeats)] for run in wanted]
    runs = [repeats[0][0] for repeats in measured]
    points = [
        Point(
            model=candidate.title,
            rung=candidate.name,
            setting=tolerance,
            modes=None,
            numerics=f"tolerance {tolerance:g}",
            error_deg_s=_error(finest, found),
            curve_error=_curve_error(finest, found),
            integration_error_deg_s=error,
            wall_s=statistics.median(wall for _, wall, _ in repeats),
            status=found.status,
            reference=False,
        )
        for tolerance, found, error, repeats in zip(
            tolerances, runs, _integration_errors(wanted[0], runs), measured
        )
    ]
    return points[::-1]


def _integration_errors(tightest: Run, runs: list[Trajectory]) -> list[float | None]:
    """Largest error (deg/s) of a settled rate by the tolerance of each of the ``runs``, the first
    of which is the ``tightest`` one and has None. A run that chose other rail modes is compared
    with a tight run with these modes, because modes are part of the model."""
    tight = {runs[0].numerics.get("modes"): runs[0]}
    for found in runs[1:]:
        if (modes := found.numerics.get("modes")) not in tight:
            tight[modes] = execute(with_modes_of(found, tightest))
    return [
        None,
        *(verdicts.settled_change(tight[run.numerics.get("modes")], run) for run in runs[1:]),
    ]


def matched(points: Sequence[Point]) -> list[Match]:
    """For each surrogate: the fastest mesh with an error at most as large, and the ratio of wall
    times. The error of a surrogate is that at its tightest tolerance, because step errors can
    cancel it by chance. Its time is that of the fastest tolerance that adds at most a tenth to this
    error. The error of the finest mesh, the reference, is zero by definition. A mesh that did not
    settle has no error and is not used. A surrogate that did not settle at its tightest tolerance
    is left out. Points with other numbers of modes are left out too, because they have one
    tolerance only."""
    points = [point for point in points if point.modes is None]
    meshes = [point for point in points if point.model == FINITE_ELEMENTS]
    found = []
    for model in dict.fromkeys(point.model for point in points if point.model != FINITE_ELEMENTS):
        own = [point for point in points if point.model == model]
        tightest = min(own, key=lambda point: point.setting)
        error = tightest.error_deg_s
        accurate = [mesh for mesh in meshes if _is_within(mesh, mesh.error_deg_s, error)]
        if error is not None and accurate:
            enough = [
                point
                for point in own
                if point is tightest
                or _is_within(point, point.integration_error_deg_s, 0.1 * error)
            ]
            point = min(enough, key=lambda point: point.wall_s)
            mesh = min(accurate, key=lambda point: point.wall_s)
            found.append(
                Match(
                    model=model,
                    numerics=point.numerics,
                    error_deg_s=error,
                    wall_s=point.wall_s,
                    mesh=mesh.numerics,
                    mesh_error_deg_s=mesh.error_deg_s,
                    mesh_is_reference=mesh.reference,
                    mesh_wall_s=mesh.wall_s,
                    ratio=mesh.wall_s / point.wall_s,
                )
            )
    return found


def _is_within(point: Point, error: float | None, limit: float | None) -> bool:
    """Whether an ``error`` of a point is known (not None) and at most ``limit``."""
    if limit is None:
        return False
    return point.reference or (error is not None and error <= limit)


def marked(points: Sequence[Point], band: float | None) -> list[Point]:
    """The points with ``pareto``: whether no faster point has an error bound as small. Without a
    ``band``, bounds are not known."""
    known = [item for item in choice.trusted(points, band) if math.isfinite(item.bound_deg_s)]

    def beaten(item: Trusted) -> bool:
        return any(
            other.bound_deg_s <= item.bound_deg_s and other.point.wall_s < item.point.wall_s
            for other in known
        )

    best = [item.point for item in known if not beaten(item)]
    return [replace(point, pareto=point in best) for point in points]
