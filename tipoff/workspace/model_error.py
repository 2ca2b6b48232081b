"""The error of one surrogate run by its model, from runs with other numerics.

| part | the rates change |
|---|---|
| tolerance | at a tighter tolerance (``workspace.disturbed``) |
| rail mesh | if the compliance of the rail is larger by its uncertainty, and its frequencies lower by theirs |
| rail modes | if all modes of the rail compliance vibrate |
| pad patterns | at the next lower degree; at the next higher one if the rail compliance has it |
| contact cells | with twice as many cells along each edge of a pad face |

The change by the lower degree is several times the error of the degree of the run, because the series
converges. Modes above those of the rail compliance are quasi-static. ``results.model_error`` combines the
parts. A sensitive run has the range of its neighbours instead: a change of its numerics moves
it as far as a change of the clearance by less than anybody knows it. The error is stored beside the run,
``lowfi/*.error.json``.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache as once
from functools import partial

import numpy as np

from tipoff import cache, sources
from tipoff.faults import SceneError
from tipoff.files import content_hash
from tipoff.lowfi.numerics import MOST_CELLS
from tipoff.mechanics import instant
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.rail_compliance import LEAST_DEGREE, patterns
from tipoff.results.model_error import ModelError, Range
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.rail_compliance import of_scene
from tipoff.workspace import disturbed
from tipoff.workspace.disturbed import Disturbed
from tipoff.workspace.run import Run, execute, with_modes_of
from tipoff.workspace.store import Store

RAIL_MESH, MODES, PATTERNS = "rail mesh", "rail modes", "pad patterns"
CELLS, TOLERANCE = "contact cells", "tolerance"
_SUFFIX = ".error.json"
NEIGHBOURS = 8  # of a sensitive run, beside those of ``Disturbed``
_FACTOR = "rail.mount_stiffness.factor"
_KEPT: cache.Cache[ModelError] = cache.documents(ModelError.plain, ModelError.of)


def kept(store: Store, run: Run, nominal: Trajectory, moved: Disturbed) -> ModelError:
    """As ``measured``, read from the ``store`` if it is there with the same key, else computed and stored."""
    return _KEPT.get_or_make(
        store.path(run).with_suffix(_SUFFIX),
        content_hash(run.key, disturbed.plain(moved), sources.of_runs(__name__)),
        "its error is computed again",
        lambda: measured(run, nominal, moved),
    )


def range_of(store: Store, run: Run, nominal: Trajectory, clearance_change: float) -> Range | None:
    """The range over the neighbours of ``nominal``, which is of ``run``, as ``kept``; None for a run that is not
    sensitive to ``clearance_change`` (m) and for one without rates."""
    if nominal.outcome.rate is None:
        return None
    moved = disturbed.kept(store, run, nominal, clearance_change)
    if not disturbed.is_sensitive(moved, run.scene):
        return None
    return kept(store, run, nominal, moved).range


def is_kept(store: Store, run: Run) -> bool:
    """Whether a file in the ``store`` has an error of ``run``, maybe of another version."""
    return store.path(run).with_suffix(_SUFFIX).exists()


def measured(run: Run, nominal: Trajectory, moved: Disturbed) -> ModelError:
    """The error of ``nominal``, which is of ``run``, has rates, and is ``moved`` by small disturbances."""
    if run.calibration is not None:
        run = replace(run, scene=run.calibration.apply(run.scene), calibration=None)
    run = with_modes_of(nominal, run)
    if disturbed.is_sensitive(moved, run.scene):
        words = "the run is sensitive, and the range of its neighbours is the answer"
        return ModelError(not_known=words, range=_range(run, nominal, moved))
    if run.model != COMPLIANT:
        return ModelError(not_known="tipoff compare measures the error of springs")
    assert moved.by_tolerance_deg_s is not None  # or the run is sensitive
    parts = {TOLERANCE: moved.by_tolerance_deg_s}
    for name, changed in _changed(run):
        if changed is None:
            assert run.compliance is not None
            why = run.compliance.known().not_known or "not stated by this rail compliance"
            return ModelError(not_known=f"{name}: {why}")
        try:
            change = instant.change(nominal.outcome, execute(changed).outcome)
        except SceneError as error:  # its payload has no place of rest
            why = "; ".join(str(fault) for fault in error.faults)
            return ModelError(not_known=f"{name}: the run that shows its effect fails ({why})")
        if change is None:
            return ModelError(not_known=f"{name}: the run that shows its effect has no rates")
        parts[name] = change
    return ModelError(parts_deg_s=parts)


def told(run: Run, nominal: Trajectory, limit: float) -> Trajectory:
    """``nominal``, which is of ``run``, with its changes among its checks, the warnings of ``disturbed`` in its
    message, and its error by the model; unchanged if it does not settle. The further runs
    are made when one of the three is first used: a loop over many runs that reads none of them takes no
    time for them."""
    from tipoff.lowfi.ensemble import twins  # slow to load

    if nominal.outcome.rate is None:
        return nominal
    moved = once(partial(disturbed.measured, run, nominal, twins.CLEARANCE_CHANGE))
    checked = nominal.completed_by(lambda: _told(nominal, moved(), limit), "checks", "message")
    return checked.completed_by(
        lambda: replace(nominal, error=measured(run, nominal, moved())), "error"
    )


def _told(nominal: Trajectory, found: Disturbed, limit: float) -> Trajectory:
    changes = {
        "rate_change_by_tolerance_deg_s": found.by_tolerance_deg_s,
        "rate_change_by_clearance_deg_s": found.by_clearance_deg_s,
    }
    checks = nominal.checks | {key: each for key, each in changes.items() if each is not None}
    message = "; ".join(filter(None, [nominal.message, *disturbed.warnings(found, limit)]))
    return replace(nominal, checks=checks, message=message)


def _changed(run: Run) -> Iterator[tuple[str, Run | None]]:
    """Each part but the tolerance, with the run that shows it; None if that is not known."""
    numerics, walls, scene = run.numerics, run.compliance, run.scene
    if scene.contact is None or walls is None:
        return
    walls = of_scene(walls, scene)  # a softer one has no terms for the factor
    if scene.rail.mount_stiffness is not None:
        scene = scene.replace({_FACTOR: 1.0})
    softer = walls.softer
    yield RAIL_MESH, None if softer is None else replace(run, scene=scene, compliance=softer)
    if (held := walls.frequency.shape[1]) > numerics.count:
        yield MODES, replace(run, numerics=replace(numerics, modes=held))
    degree = numerics.known_degree or walls.degree
    if degree < walls.degree:
        yield PATTERNS, replace(run, numerics=replace(numerics, degree=degree + 1))
    elif degree > LEAST_DEGREE:
        # in the arrays of the degree of the run, whose kernel is compiled
        fewer = walls.restricted(patterns.count(degree - 1))
        yield PATTERNS, replace(run, scene=scene, compliance=fewer)
    cells = min(2 * numerics.cells, MOST_CELLS)
    yield CELLS, replace(run, numerics=replace(numerics, cells=cells))


def _range(run: Run, nominal: Trajectory, moved: Disturbed) -> Range:
    """Range of velocity and rates over the run, the run at a tighter tolerance, and ``NEIGHBOURS`` with
    clearances evenly spaced within the change of ``moved``."""
    every, contact = [disturbed.tighter(run)], run.scene.contact
    if contact is not None and (most := moved.clearance_change_m) is not None:
        every += [
            replace(run, scene=run.scene.replace(contact.either_way(abs(step))[side]))
            for step in np.linspace(-most, most, NEIGHBOURS).tolist()
            if (side := "minus" if step < 0.0 else "plus") in contact.either_way(abs(step))
        ]
    at = instant.of_outcome(nominal.outcome)
    runs = [nominal.outcome, *(execute(each).outcome for each in every)]
    known = [outcome for outcome in runs if instant.rate(outcome, at) is not None]
    rates = np.degrees(np.array([instant.rate(outcome, at) for outcome in known]))
    velocity = np.array([instant.velocity(outcome, at) for outcome in known])
    off, across = np.degrees(instant.off(velocity)), instant.lateral(velocity)
    return Range(
        low_deg_s=tuple(rates.min(axis=0).tolist()),
        high_deg_s=tuple(rates.max(axis=0).tolist()),
        low_m_s=tuple(velocity.min(axis=0).tolist()),
        high_m_s=tuple(velocity.max(axis=0).tolist()),
        off_axis_deg=_ends(off),
        across_m_s=_ends(across),
        runs=len(known),
        lost=len(runs) - len(known),
        rates_deg_s=tuple(map(tuple, rates.tolist())),
    )


def _ends(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())
