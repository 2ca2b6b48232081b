"""The impulse of the thrust after the exit, and the same launcher with a longer or shorter thrust.

A thrust stretched by f keeps its impulse: the force is divided by f, the times are multiplied by f.
Thrust after the exit turns a free payload, so the rate grows with the error. If the thrust burns
out on the rail, the clearance limits the angle.
"""

from typing import NamedTuple

from tipoff import lowfi
from tipoff.lowfi.numerics import Numerics
from tipoff.scenes.scene import Scene
from tipoff.studies.populations.population import TOLERANCE, Surrogate

_LEAVES_UNDER_THRUST, _BURNS_OUT = 0.15, 0.001  # share of the impulse after the exit
_MOST = 7  # doublings of the stretch


class Exit(NamedTuple):
    """Exit of a launch without errors: its time (s) and the share of the impulse after it. The
    share is zero without thrust: a launch by gravity or by the speed at ignition."""

    time: float
    share_after: float


def exit_of(model: Surrogate) -> Exit | None:
    """The exit of the payload; None if it does not leave."""
    found = lowfi.run(
        model.scene,
        model.name,
        numerics=Numerics(relative_tolerance=TOLERANCE),
        compliance=model.compliance,
    ).outcome
    if found.exit_time is None:
        return None
    return Exit(found.exit_time, found.impulse_after_exit or 0.0)


def stretched(scene: Scene, factor: float) -> dict[str, float] | None:
    """Overrides (SI) that stretch the thrust and, if it becomes longer, a stated duration. None for
    a kind of thrust without such numbers."""
    table = scene.thrust
    if table.kind == "constant":
        found = {
            "thrust.force": table.force / factor,
            "thrust.start": table.start * factor,
            "thrust.duration": table.duration * factor,
        }
    elif table.kind in ("gaussian", "gaussians"):
        found = {}
        for number, pulse in enumerate(table.pulses()):
            head = "thrust" if table.kind == "gaussian" else f"thrust.components.{number}"
            found |= {
                f"{head}.width": pulse.width * factor,
                f"{head}.centre": pulse.centre * factor,
            }
            found |= {f"{head}.peak": pulse.peak / factor} if pulse.peak is not None else {}
    else:
        return None
    if scene.duration is None:
        return found
    return found | {"duration": scene.duration * max(factor, 1.0)}


def other_way(model: Surrogate) -> tuple[float, Surrogate, Exit] | None:
    """Stretch, surrogate and exit with thrust after the exit if ``model`` has none there, and
    without it if ``model`` has some.

    None if the payload does not leave, or if no stretch up to 2^7 is enough.
    """
    nominal = exit_of(model)
    if nominal is None:
        return None
    longer = nominal.share_after < _LEAVES_UNDER_THRUST
    for doubling in range(1, _MOST + 1):
        factor = 2.0**doubling if longer else 0.5**doubling
        overrides = stretched(model.scene, factor)
        if overrides is None:
            return None
        changed = model.at(overrides)
        found = exit_of(changed)
        if found and (
            found.share_after >= _LEAVES_UNDER_THRUST if longer else found.share_after <= _BURNS_OUT
        ):
            return factor, changed, found
    return None
