"""Change of the rates of one surrogate run by 1 um of clearance and by a tighter tolerance, at the
instant that counts for it (``mechanics.instant``).

In a chaotic ejection both changes grow from contact to contact (``studies.agreement.growth``). They limit
the accuracy of any single run of such a case. The changes are stored beside the run, ``lowfi/*.disturbed.json``.
"""

import math
from dataclasses import asdict, dataclass, fields, replace

from tipoff import cache, sources
from tipoff.files import content_hash
from tipoff.mechanics import instant
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.workspace.run import Run, execute, with_modes_of
from tipoff.workspace.store import Store


@dataclass(frozen=True, kw_only=True)
class Disturbed:
    """Largest changes of a rate, None if the disturbed run does not settle: at a tighter
    ``tolerance``, and by plus or minus ``clearance_change_m`` of every clearance, None without
    contact."""

    tolerance: float
    by_tolerance_deg_s: float | None
    clearance_change_m: float | None = None
    by_clearance_deg_s: float | None = None


def _loaded(found: dict) -> Disturbed:
    return Disturbed(**{item.name: found[item.name] for item in fields(Disturbed)})


_KEPT: cache.Cache[Disturbed] = cache.documents(asdict, _loaded)


def kept(store: Store, run: Run, nominal: Trajectory, clearance_change: float) -> Disturbed:
    """As ``measured``, read from the ``store`` if it is there with the same key, else computed and stored."""
    key = content_hash(run.key, clearance_change, sources.of_runs(__name__))
    return _KEPT.get_or_make(
        store.path(run).with_suffix(".disturbed.json"),
        key,
        "its disturbed runs are made again",
        lambda: measured(run, nominal, clearance_change),
    )


def measured(run: Run, nominal: Trajectory, clearance_change: float) -> Disturbed:
    """Changes by ``clearance_change`` (m), and by a tighter tolerance."""
    if run.calibration is not None:  # its clearance is changed
        run = replace(run, scene=run.calibration.apply(run.scene), calibration=None)
    run = with_modes_of(nominal, run)
    tight = tighter(run)
    found = Disturbed(
        tolerance=tight.numerics.relative_tolerance,
        by_tolerance_deg_s=_change(nominal, tight),
    )
    if run.scene.contact is None:
        return found
    changes = [
        _change(nominal, replace(run, scene=run.scene.replace(changed)))
        for changed in run.scene.contact.either_way(clearance_change).values()
    ]
    known = [change for change in changes if change is not None]
    worst = max(known) if len(known) == len(changes) and known else None
    return replace(found, clearance_change_m=clearance_change, by_clearance_deg_s=worst)


def tighter(run: Run) -> Run:
    """The run at a tighter tolerance."""
    from tipoff.lowfi.ensemble import twins  # slow to load

    return replace(run, numerics=twins.tight(run.numerics))


def plain(found: Disturbed) -> dict:
    """The changes for JSON."""
    return asdict(found)


def is_sensitive(found: Disturbed, scene: Scene) -> bool:
    """Whether a change is above the limit of agreement of the ``scene``, or a disturbed run does not
    settle."""
    return bool(warnings(found, math.degrees(scene.agreement.settled_limit)))


def _change(nominal: Trajectory, changed: Run) -> float | None:
    return instant.change(nominal.outcome, execute(changed).outcome)


def lines(found: Disturbed) -> list[str]:
    """The result as text."""
    words = [
        f"{cause}: does not settle" if value is None else f"{value:.2g} deg/s by {cause}"
        for cause, value in _changes(found).items()
    ]
    return [f"  sensitivity   {', '.join(words)}"]


def warnings(found: Disturbed, limit: float) -> list[str]:
    """A warning for each change above ``limit`` (deg/s), or after which the run does not settle."""
    told = []
    for cause, value in _changes(found).items():
        if value is None or value > limit:
            how = (
                "prevents the run from settling"
                if value is None
                else f"changes a rate by {value:.2g} deg/s"
            )
            told.append(f"sensitive: {cause} {how}. Use an ensemble instead of a single run")
    return told


def _changes(found: Disturbed) -> dict[str, float | None]:
    """The changes by their causes."""
    changes = {f"tolerance {found.tolerance:g}": found.by_tolerance_deg_s}
    if found.clearance_change_m is not None:
        changes[f"{1e6 * found.clearance_change_m:g} µm of clearance"] = found.by_clearance_deg_s
    return changes
