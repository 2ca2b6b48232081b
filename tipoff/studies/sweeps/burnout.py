"""Whether a payload leaves its rail while the thrust still acts, and the same launcher with a
thrust so long, or so short, that it is the other way round.

A thrust stretched by f keeps its impulse: force by 1/f, times by f. What acts after the exit turns
a free payload, so its rate grows with the error however the rail limits the angle before; what
burns out on the rail leaves it to the walls, whose clearance limits the angle.
"""

from typing import NamedTuple

from tipoff import lowfi
from tipoff.lowfi.numerics import Numerics
from tipoff.scenes.effects import thrust
from tipoff.scenes.scene import Scene
from tipoff.studies.populations.population import TOLERANCE, Surrogate

_LEAVES_UNDER_THRUST, _BURNS_OUT = 0.15, 0.001  # share of the impulse after the exit
_ROUNDING = 1e-12  # of a difference of two equal impulses
_MOST = 7  # doublings of the stretch


class Exit(NamedTuple):
    """Of a launch without errors: time of the exit (s) and share of the impulse that acts after
    it."""

    time: float
    share_after: float


def exit_of(model: Surrogate) -> Exit | None:
    """How the payload leaves, or None where it does not."""
    time = lowfi.run(
        model.scene,
        model.name,
        numerics=Numerics(relative_tolerance=TOLERANCE),
        compliance=model.compliance,
    ).outcome.exit_time
    if time is None:
        return None
    record, duration = model.scene.thrust.record(), model.scene.duration
    after = 1.0 - thrust.impulse(record, time) / thrust.impulse(record, duration)
    return Exit(time, after if after > _ROUNDING else 0.0)


def stretched(scene: Scene, factor: float) -> dict[str, float] | None:
    """Overrides (SI) that stretch the thrust, and the scene's duration with a longer one; None for
    a kind that has no such numbers."""
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
    return found | {"duration": scene.duration * max(factor, 1.0)}


def other_way(model: Surrogate) -> tuple[float, Surrogate, Exit] | None:
    """Stretch, surrogate and its exit where the thrust acts after the exit if it does not in
    ``model``, and the other way round.

    None where the payload does not leave or no stretch up to 2^7 does it.
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
