"""Advice for a run whose payload is jammed, or that reached the end of its scene before the payload
left the rail, or before its rates settled (status ``time_limit``).

The definitions of exit and settled window are those of ``mechanics.outcome``.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from tipoff.mechanics import ledger
from tipoff.mechanics.estimates import ends, stop
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.outcome import BEHIND, relative_motion
from tipoff.mechanics.run_limits import LONGEST, MOST_SAMPLES, SETTLE_DELAY, SETTLE_WINDOW
from tipoff.scenes import launch
from tipoff.scenes.rounding import below
from tipoff.scenes.scene import Scene
from tipoff.units import duration

if TYPE_CHECKING:
    from tipoff.results.trajectory import Trajectory

_HORIZON = 100.0  # durations of the scene in which the end of the thrust is searched
_BURNT = 1e-3  # of the peak, as in ``mechanics.outcome``
_STEP = 1e-5  # s, durations are rounded up to it
_TELLING = 1e-3  # of the energy that a payload had: smaller parts are not named
_MARGIN = 1e-3  # s: a payload that turns leaves the rail later than its mass centre suggests


def advice(scene: Scene, run: "Trajectory") -> str:
    """Reason why a ``run`` of ``scene`` is jammed, has the status ``time_limit``, or is diverged although
    a pad begins behind its rail, and what helps; empty for any other run."""
    if run.status == "diverged":
        return _behind_the_rail(scene)
    if run.status == "jammed":
        return _jammed(scene, run)
    if run.status != "time_limit":
        return ""
    burnt = thrust_law.burnout(scene.thrust.record(), _BURNT, _HORIZON * scene.time_limit)
    if burnt >= _HORIZON * scene.time_limit:
        return (
            "the thrust does not end within the scene, so no rate settles: state a thrust that ends"
        )
    if run.outcome.exit_time is not None:
        return _before_settling(run.outcome.exit_time, burnt) + _without(scene)
    return _on_the_rail(scene, run, burnt)


def foreseen(scene: Scene) -> str:
    """Reason why no run of ``scene`` can settle within its stated duration, for any friction, and a
    remedy; empty if this cannot be known in advance."""
    least = 0.0 if scene.duration is None else ends.earliest(launch.of_scene(scene))
    if scene.duration is None or not below(scene.duration, least):
        return ""
    if not math.isfinite(least):
        return "a thrust that moves the payload: without friction it does not leave the rail either"
    return f"at least {duration(_up(least))}: without friction its rates settle no earlier{_without(scene)}"


def _without(scene: Scene) -> str:
    """The remedy without a number."""
    if scene.duration is None:
        return ""
    return "; without duration a run ends by itself, once its rates have settled"


def _before_settling(exit_time: float, thrust_ends: float) -> str:
    start = max(exit_time + SETTLE_DELAY, thrust_ends)
    cause = (
        f"thrust falls below 0.1 % of its peak at {duration(thrust_ends)}"
        if thrust_ends > exit_time + SETTLE_DELAY
        else f"the payload leaves the rail at {duration(exit_time)}"
    )
    return f"{cause}; settling needs a duration of {duration(_up(start + SETTLE_WINDOW))}"


def _behind_the_rail(scene: Scene) -> str:
    """The pads that no wall guides to the rear end of the rail, if there are any."""
    start = scene.rail.start
    if scene.contact is None or not (behind := launch.pads_beyond(scene, start, -1.0)):
        return ""
    listed = ", ".join(map(str, behind))
    begun = scene.initial.position.x if scene.initial is not None else 0.0
    rear = begun + min(pad.position[0] - 0.5 * pad.length for pad in scene.pads)
    return (
        f"the rail starts at X = {start:.6g} m, in front of pads {listed}: no wall guides them, and they "
        f"may strike its rear end; start the rail at {rear:.6g} m or behind that"
    )


def _jammed(scene: Scene, run: "Trajectory") -> str:
    way, whole, speeds = _progress(scene, run)
    along = launch.of_scene(scene)
    if stop.is_there(along):
        weight = f"{stop.weight(along):.4g} N of its weight along the rail"
        if stop.release_time(along) == math.inf:
            return f"it rests on its stop: it needs a thrust of more than the {weight}"
        if way < -0.5 * BEHIND:
            at = duration(float(run.time[-1]))
            return f"fell back on its stop at {at}: it needs thrust that stays above the {weight}"
    elif along.place + way < along.rear_end + BEHIND:
        pulled = stop.weight(along) > 0.0
        cause = "its weight pulls it, and no stop or latch holds it ([hold_down] release)"
        fell = f"fell off the rear end of the rail at {duration(float(run.time[-1]))}"
        return f"{fell}: {cause if pulled else 'nothing holds it there'}"
    work = dict(zip(ledger.ENTRIES, run.energy[-1].tolist(), strict=True))
    weight = work[ledger.BODY_FORCE]
    given = {
        "from the thrust": work["thrust"],
        "from its start": float(run.energy[0, ledger.STATE].sum()),
        "from the body forces": max(weight, 0.0),
    }
    spent = {"friction": work["friction"], "its weight": max(-weight, 0.0)}
    least = _TELLING * sum(given.values())
    energy, taken = (
        " and ".join(f"{joule:.3g} J {name}" for name, joule in each.items() if joule > least)
        for each in (given, {f"to {name}": joule for name, joule in spent.items()})
    )
    stuck = f"stuck on the rail: {1e3 * way:.3g} of {1e3 * whole:.3g} mm"
    if not energy:
        return f"{stuck}; nothing moved it: it needs thrust{_rubbed(scene)}"
    if not work["friction"] > least:
        return f"{stuck}, {speeds.max():.2g} m/s at most; it had {energy}: it needs more thrust"
    return (
        f"{stuck}, {speeds.max():.2g} m/s at most; it had {energy} and lost {taken or 'none'}: it needs less"
        " friction, or more thrust that presses the pads no harder"
    )


def _progress(scene: Scene, run: "Trajectory") -> tuple[float, float, np.ndarray]:
    """Way (m) of the payload along the rail, the whole way to the exit (m), and its axial speeds (n,)
    m/s."""
    moved = relative_motion(run)
    place = moved["relative_position"][:, 0]
    return float(place[-1] - place[0]), launch.of_scene(scene).way, moved["relative_velocity"][:, 0]


def _on_the_rail(scene: Scene, run: "Trajectory", thrust_ends: float) -> str:
    way, whole, speeds = _progress(scene, run)
    speed, now = float(speeds[-1]), float(run.time[-1])
    if way < 0.0 and speed < 0.0 and stop.weight(launch.of_scene(scene)) > 0.0:
        slid = f"slid back along the rail: {-1e3 * way:.3g} mm behind its start, at {speed:.2g} m/s"
        return f"{slid}: its weight pulls it, and no stop or latch holds it ([hold_down] release)"
    text = f"still on the rail: {1e3 * way:.3g} of {1e3 * whole:.3g} mm"
    exit_time = now + (whole - way) / speed if speed > 0.0 else math.inf
    if exit_time > LONGEST:
        lasts = (
            f" (it lasts until {duration(thrust_ends)})" if thrust_ends > scene.time_limit else ""
        )
        return f"{text}, at {speed:.2g} m/s: it needs more thrust{lasts}{_rubbed(scene)}"
    settled = max(exit_time + SETTLE_DELAY, thrust_ends) + SETTLE_WINDOW + _MARGIN
    enough = f"at this speed a duration of {duration(_up(settled))} is enough"
    if scene.duration is None and settled > ends.longest(scene.output.interval):
        enough += f", with output.interval of at least {duration(settled / MOST_SAMPLES)}"
    return f"{text}, at {speed:.3g} m/s; {enough}{_without(scene)}"


def _rubbed(scene: Scene) -> str:
    """The remedy of friction, if there is any."""
    return ", or less friction" if scene.friction is not None else ""


def _up(time: float) -> float:
    return math.ceil(time / _STEP - 1e-9) * _STEP
