"""Rates of a payload by a hand calculation, for comparison with a run: moment impulse over inertia.

    w = w_0 + J^-1 (r x d I + sum over the pad of integral of c x f dt)

with the inertia J, the impulse I of the thrust along d at r from the mass centre, and the force f
on the only pad that touches, at c; all in body axes. The gyroscopic term w x J w and the effect of
a second pad are left out. So the result is valid if no pad or one pad touches. A spring pushes in a
direction of the platform, so its lever grows while the payload turns: by about the angle times the
distance of the spring, which must be small beside the moment.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.outcome import relative_motion
from tipoff.scenes import launch, scene_model
from tipoff.scenes.scene import Scene

if TYPE_CHECKING:
    from tipoff.results.trajectory import Trajectory


_GROWTH = 0.1  # of the moment of the springs


class ByHand(NamedTuple):
    """Result of the calculation."""

    rate: np.ndarray  # (3,) rad/s, in body axes
    pad: int | None  # index of the pad that touches

    @property
    def words(self) -> str:
        """Names the pads that are included."""
        touched = "no pad touches" if self.pad is None else f"pad {self.pad + 1} alone touches"
        return f"moment impulse over inertia, {touched}"


def rates(scene: Scene, run: "Trajectory") -> ByHand | None:
    """Rates of a settled ``run`` of ``scene`` by hand; None if more than one pad touches in its
    samples, if the payload turns so far on its springs that their levers change, or if it did not
    settle."""
    if run.outcome.rate is None:
        return None
    model = scene_model.build(scene)
    touching = np.flatnonzero((run.pad_force != 0.0).any(axis=(0, 2)))
    pads = sorted(set(model.faces.pad[touching].tolist()))
    if len(pads) > 1:
        return None
    moment = np.zeros(3)
    if model.pushers is not None:
        pushes, impulses = model.pushers, ends.spring_impulses(launch.of_scene(scene))
        moment += impulses @ np.cross(pushes.point, pushes.direction)
        grown = _turned(run, pushes.travel.max()) * impulses @ np.linalg.norm(pushes.point, axis=1)
        if grown > _GROWTH * np.linalg.norm(moment):
            return None
    elif model.thrust_offset is not None:
        offset, impulse = model.thrust_offset, thrust_law.impulse(model.thrust, scene.time_limit)
        moment += impulse * np.cross(offset.arm, offset.direction)
    for face in touching:
        # scene axes to body axes
        force = np.einsum("nji,nj->ni", rotation.matrices(run.quaternion), run.pad_force[:, face])
        moment += np.cross(model.faces.centre[face], np.trapezoid(force, run.time, axis=0))
    begun = np.array(model.initial.rate)
    return ByHand(begun + model.payload.inverse_inertia @ moment, pads[0] if pads else None)


def _turned(run: "Trajectory", stroke: float) -> float:
    """Angle (rad) by which the payload has turned once it has travelled by ``stroke`` (m)."""
    travel = relative_motion(run)["relative_position"][:, 0]
    end = min(int(np.searchsorted(travel - travel[0], stroke)), len(travel) - 1)
    cosine = abs(float(run.quaternion[0] @ run.quaternion[end]))
    return 2.0 * math.acos(min(cosine, 1.0))
