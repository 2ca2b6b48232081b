"""What the page computes for a scene: a quick run while a slider moves, the run itself when it
rests, and how far small changes move its rates."""

import math
from typing import NamedTuple

import numpy as np

import tipoff

CLEARANCE_CHANGE = 1e-6  # m
TIGHT = 1e-10  # relative tolerance


class Disturbance(NamedTuple):
    """Largest change of a settled rate (deg/s) by 1 um of clearance either way and by a relative
    tolerance of 1e-10, as ``tipoff run`` prints them; None where a disturbed run does not settle."""

    by_clearance: float | None
    by_tolerance: float | None


def compliance(scene: tipoff.Scene) -> tipoff.RailCompliance | None:
    """Compliance of the rails, from the cache of the user or from finite elements; None for a scene
    without contact. It does not depend on any value that the page changes."""
    return tipoff.compliance(scene) if scene.contact is not None else None


def quick(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> tipoff.Trajectory:
    """The ejection of ``scene`` from rails without inertia, a tenth of the time of ``run`` where the
    rails vibrate. Raises SceneError."""
    return tipoff.run(scene, compliance=found, sensitivity=False, modes=0)


def run(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> tipoff.Trajectory:
    """The ejection of ``scene``, with as many modes of the rails as its rates need. Raises
    SceneError."""
    return tipoff.run(scene, compliance=found, sensitivity=False)


def disturbed(
    scene: tipoff.Scene, found: tipoff.RailCompliance | None, nominal: tipoff.Trajectory
) -> Disturbance:
    """How far small changes move the settled rates of ``nominal``, the run of ``scene``, which has
    exited. The rails keep their number of modes, so that nothing else moves the rates."""

    def change(of: tipoff.Scene, **numerics: float) -> float | None:
        modes = nominal.numerics["modes"]
        moved = tipoff.run(of, compliance=found, sensitivity=False, modes=modes, **numerics)
        if moved.outcome.rate is None:
            return None
        return math.degrees(np.abs(np.subtract(moved.outcome.rate, nominal.outcome.rate)).max())

    gaps = scene.contact.either_way(CLEARANCE_CHANGE).values() if scene.contact else ()
    changes = [change(scene.replace(gap)) for gap in gaps]
    return Disturbance(
        by_clearance=None if None in changes else max(changes, default=0.0),
        by_tolerance=change(scene, relative_tolerance=TIGHT),
    )
