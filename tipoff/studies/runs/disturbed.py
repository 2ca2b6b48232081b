"""How far 1 um of clearance and a tighter tolerance move the settled rates of one surrogate run.

In a chaotic ejection both grow from contact to contact (``studies.agreement.growth``). No single
run predicts the rates of such a case better than this.
"""

from dataclasses import replace

from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.agreement.verdicts import largest, settled_change
from tipoff.studies.core.store import Run, execute

TOLERANCE = 1e-10  # relative, of a step


def of(run: Run, nominal: Trajectory, clearance_change: float) -> dict[str, float | None]:
    """Largest changes of a settled rate (deg/s) by ``clearance_change`` (m) either way and by
    ``TOLERANCE``. None: a run does not settle where the other does, or ``run`` has no contact."""
    tight = replace(run.numerics, relative_tolerance=TOLERANCE)
    by_tolerance = _change(nominal, replace(run, numerics=tight))
    by_clearance = None
    if run.scene.contact is not None:
        clearance = run.scene.contact.clearance
        changed = [value for sign in (1, -1) if (value := clearance + sign * clearance_change) >= 0]
        changes = [
            _change(nominal, replace(run, scene=run.scene.replace({"contact.clearance": value})))
            for value in changed
        ]
        by_clearance = None if None in changes else largest(changes)
    return {
        "clearance_change_m": clearance_change,
        "by_clearance_deg_s": by_clearance,
        "tolerance": TOLERANCE,
        "by_tolerance_deg_s": by_tolerance,
    }


def _change(nominal: Trajectory, changed: Run) -> float | None:
    return settled_change(nominal, execute(changed))


def lines(found: dict, limit: float) -> list[str]:
    """The result of ``of`` as text, with a warning above ``limit`` (deg/s)."""
    causes = [
        (f"tolerance {found['tolerance']:g}", found["by_tolerance_deg_s"]),
        (f"{1e6 * found['clearance_change_m']:g} µm of clearance", found["by_clearance_deg_s"]),
    ]
    moved = [(cause, value) for cause, value in causes if value is not None]
    if not moved:
        return []
    words = ", ".join(f"{value:.2g} deg/s by {cause}" for cause, value in moved)
    cause, most = max(moved, key=lambda item: item[1])
    warning = (
        f"  warning       sensitive: {cause} moves a rate by {most:.2g} deg/s. Use an ensemble "
        "instead of a single run"
    )
    return [f"  sensitivity   {words}"] + [warning] * (most > limit)
