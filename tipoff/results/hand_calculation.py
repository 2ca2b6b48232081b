"""Rates of a payload by a hand calculation, for comparison with a run: moment impulse over inertia.

    w = w_0 + J^-1 (r x d I + sum over the pad of integral of c x f dt)

with the inertia J, the impulse I of the thrust along d at r from the mass centre, and the force f
on the only pad that touches, at c; all in body axes. The gyroscopic term w x J w and the effect of
a second pad are left out. So the result is valid if no pad or one pad touches. A spring pushes in a
direction of the platform, so its lever grows while the payload turns: by about the angle times the
distance of the spring, which must be small beside the moment.

A rocket whose front button has left turns about its rear one (``mechanics.estimates.pin``). This is the rate at exit.
A lug or a shoe has two ends. It is a pin while neither reaches the other wall: half its length times the angle,
half of w dt, is below the play.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tipoff.kernels import rotation
from tipoff.mechanics.estimates import ends, pin
from tipoff.mechanics.instant import EXIT, SETTLED
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.outcome import relative_motion
from tipoff.results import guides
from tipoff.results.guides import Vector
from tipoff.scenes import launch, scene_model
from tipoff.scenes.scene import Scene

if TYPE_CHECKING:
    from tipoff.results.trajectory import Trajectory


_GROWTH = 0.1  # of the moment of the springs


@dataclass(frozen=True)
class ByHand:
    """Rates of a payload by a hand calculation.

    Example:
        >>> free = tipoff.load("tiny").replace({"contact": None, "friction": None})
        >>> tipoff.run(free).by_hand[0].words
        'moment impulse over inertia, no pad touches'
    """

    #: rad/s, in body axes.
    rate_rad_s: Vector
    #: The instant: "settled" or "exit".
    at: str
    #: What is included, and what is assumed.
    words: str


def of_run(scene: Scene, run: "Trajectory") -> tuple[ByHand, ...]:
    """The hand calculations that are valid for a ``run`` of ``scene``: settled, and at exit."""
    both = (_rates(scene, run), pinned(scene, run))
    return tuple(found for found in both if isinstance(found, ByHand))


def rates(scene: Scene, run: "Trajectory") -> ByHand | None:
    """Rates of a settled ``run`` of ``scene`` by hand; None for the reason ``why_not``."""
    found = _rates(scene, run)
    return found if isinstance(found, ByHand) else None


def why_not(scene: Scene, run: "Trajectory") -> str:
    """Why ``rates`` are None; empty if they are not."""
    found = _rates(scene, run)
    return found if isinstance(found, str) else ""


def _rates(scene: Scene, run: "Trajectory") -> ByHand | str:
    if run.outcome.rate is None:
        return "the run did not settle"
    model = scene_model.build(scene)
    touching = np.flatnonzero((run.pad_force != 0.0).any(axis=(0, 2)))
    pads = sorted(set(model.faces.pad[touching].tolist()))
    if len(pads) > 1:
        return f"{len(pads)} pads touch, and each one changes what the others do"
    moment = np.zeros(3)
    if model.pushers is not None:
        pushes, impulses = model.pushers, ends.spring_impulses(launch.of_scene(scene))
        moment += impulses @ np.cross(pushes.point, pushes.direction)
        grown = _turned(run, pushes.travel.max()) * impulses @ np.linalg.norm(pushes.point, axis=1)
        if grown > _GROWTH * np.linalg.norm(moment):
            return "the payload turns so far on its springs that their levers change"
    elif model.thrust_offset is not None:
        offset, impulse = model.thrust_offset, thrust_law.impulse(model.thrust, scene.time_limit)
        moment += impulse * np.cross(offset.arm, offset.direction)
    for face in touching:
        # scene axes to body axes
        force = np.einsum("nji,nj->ni", rotation.matrices(run.quaternion), run.pad_force[:, face])
        moment += np.cross(model.faces.centre[face], np.trapezoid(force, run.time, axis=0))
    begun = np.array(model.initial.rate)
    touched = f"pad {pads[0] + 1} alone touches" if pads else "no pad touches"
    return ByHand(
        _vector(begun + model.payload.inverse_inertia @ moment),
        SETTLED,
        f"moment impulse over inertia, {touched}",
    )


def pinned(scene: Scene, run: "Trajectory") -> ByHand | str:
    """Rates at exit of a rocket on two buttons or lugs that turns about the rear one; or why it has none."""
    parts = guides.of_run(scene, run)
    if len(parts) != 2 or parts[0].name.startswith("pad") or scene.platform is not None:
        return "the rocket has not two buttons or lugs on fixed rails"
    if scene.contact is None:
        return "nothing holds the buttons or lugs"
    rear, front = sorted(parts, key=lambda each: each.place_m[0])
    name = rear.name.split()[0]
    if rear.leaves_s is None or front.leaves_s is None:
        return f"a {name} stays on the rail"
    model = scene_model.build(scene)
    behind = model.payload.mass_centre[0] - rear.place_m[0]
    if not behind > 0.0:
        return f"the rear {name} is in front of the mass centre"
    impulse = thrust_law.impulse(model.thrust, rear.leaves_s)
    impulse -= thrust_law.impulse(model.thrust, front.leaves_s)
    time = rear.leaves_s - front.leaves_s
    found = pin.rates(model, behind, impulse, time)
    places = model.faces.centre[model.faces.guide == parts.index(rear), 0]
    _, y, z = scene.contact.gaps()
    across = 0.25 * np.ptp(places) * time * np.abs(found)
    if across[1] > z or across[2] > y:
        return f"the rear {name} is so long that both its ends hold the rocket"
    words = f"a rigid rocket turns about its rear {name} after the front one left, without play and roll"
    return ByHand(_vector(found), EXIT, words)


def _vector(values: np.ndarray) -> Vector:
    x, y, z = values.tolist()
    return x, y, z


def _turned(run: "Trajectory", stroke: float) -> float:
    """Angle (rad) by which the payload has turned once it has travelled by ``stroke`` (m)."""
    travel = relative_motion(run)["relative_position"][:, 0]
    end = min(int(np.searchsorted(travel - travel[0], stroke)), len(travel) - 1)
    cosine = abs(float(run.quaternion[0] @ run.quaternion[end]))
    return 2.0 * math.acos(min(cosine, 1.0))
