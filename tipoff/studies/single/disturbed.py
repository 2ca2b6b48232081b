"""How far 1 um of clearance and a tighter tolerance move the settled rates of one surrogate run.

In a chaotic ejection both grow from contact to contact (``studies.agreement.growth``). No single
run predicts the rates of such a case better than this.
"""

from dataclasses import replace

from tipoff.lowfi.ensemble import twins
from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.agreement.verdicts import largest, settled_change
from tipoff.workspace.run import Run, execute, with_modes_of


def of(run: Run, nominal: Trajectory, clearance_change: float) -> dict[str, float | None]:
    """Largest changes of a settled rate (deg/s) by ``clearance_change`` (m) of every clearance either
    way, absent without contact, and by a tighter tolerance; None where the disturbed run does not
    settle."""
    if run.calibration is not None:  # its clearance is the one that is changed
        run = replace(run, scene=run.calibration.apply(run.scene), calibration=None)
    run = with_modes_of(nominal, run)
    tight = twins.tight(run.numerics)
    found: dict[str, float | None] = {
        "tolerance": tight.relative_tolerance,
        "by_tolerance_deg_s": _change(nominal, replace(run, numerics=tight)),
    }
    if run.scene.contact is not None:
        changes = [
            _change(nominal, replace(run, scene=run.scene.replace(changed)))
            for changed in run.scene.contact.either_way(clearance_change).values()
        ]
        found["clearance_change_m"] = clearance_change
        found["by_clearance_deg_s"] = None if None in changes else largest(changes)
    return found


def _change(nominal: Trajectory, changed: Run) -> float | None:
    return settled_change(nominal, execute(changed))


def lines(found: dict, limit: float) -> list[str]:
    """The result of ``of`` as text, with a warning where a change is above ``limit`` (deg/s) or the
    run does not settle."""
    changes = {f"tolerance {found['tolerance']:g}": found["by_tolerance_deg_s"]}
    if "by_clearance_deg_s" in found:
        cause = f"{1e6 * found['clearance_change_m']:g} µm of clearance"
        changes[cause] = found["by_clearance_deg_s"]
    words = [
        f"{cause}: does not settle" if value is None else f"{value:.2g} deg/s by {cause}"
        for cause, value in changes.items()
    ]
    warnings = [
        f"  warning       sensitive: {cause} "
        + (
            "prevents the run from settling"
            if value is None
            else (f"changes a rate by {value:.2g} deg/s")
        )
        + ". Use an ensemble instead of a single run"
        for cause, value in changes.items()
        if value is None or value > limit
    ]
    return [f"  sensitivity   {', '.join(words)}", *warnings]
