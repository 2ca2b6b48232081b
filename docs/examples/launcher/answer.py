"""What the page computes for a scene: a quick run while a slider moves, the run itself when it
rests, and how far small changes move its rates."""

import math
from typing import NamedTuple

import tipoff


class Disturbance(NamedTuple):
    """Largest change of a settled rate (deg/s) by 1 um of clearance either way and by a relative
    tolerance of 1e-10; None where a disturbed run does not settle or nothing is there to change."""

    by_clearance: float | None
    by_tolerance: float | None


def compliance(scene: tipoff.Scene) -> tipoff.RailCompliance | None:
    """Compliance of the rails, from the cache of the user or from finite elements; None for a scene
    without contact. It does not depend on any value that the page changes."""
    return tipoff.compliance(scene) if scene.contact is not None else None


def quick(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> tipoff.Trajectory:
    """The ejection of ``scene`` from rails without inertia, a tenth of the time of ``run`` where the
    rails vibrate. Raises SceneError."""
    return tipoff.run(scene, compliance=found, modes=0)


def run(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> tipoff.Trajectory:
    """The ejection of ``scene``, with as many modes of the rails as its rates need. Raises
    SceneError."""
    return tipoff.run(scene, compliance=found)


def disturbed(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> Disturbance:
    """How far small changes move the settled rates of ``scene``, which has exited."""
    cases = tipoff.ensemble(scene, [{}], compliance=found, sensitivity=True, workers=1)
    return Disturbance(
        by_clearance=_degrees(cases, "rate_change_by_clearance"),
        by_tolerance=_degrees(cases, "rate_change_by_tolerance"),
    )


def _degrees(cases, name: str) -> float | None:
    if name not in cases:
        return None
    change = math.degrees(float(cases[name].values[0]))
    return change if math.isfinite(change) else None
