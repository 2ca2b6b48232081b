"""Substeps: parts of a step, for as long as friction damps nodes faster than a whole step can follow.

Friction near rest is a damper of mu' N at each contact, and the nodes of a fine mesh are light, so a
payload that rests on its rails damps them faster than any contact that slides (``step_limit`` has
the condition). All nodes and bodies then take substeps. The elastic force is the same in them, so a
run pays what the substeps take; its ``cost`` has their number.

A whole step ends where it would have ended, so samples and their times stay. The kernel returns after
the step in which the damping exceeds the limit. Substeps get fewer at multiples of
``step_size.RASTER`` only: how coarsely a run is sampled changes no bit of it.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics import observe
from tipoff.highfi.dynamics.step_limit import used
from tipoff.highfi.dynamics.step_size import STEPS_PER_CHECK, raster_steps

MOST = 1000  # substeps of a step
# Damping by which substeps are chosen, over that of the present step: contact that still grows does
# not change them again and again.
_SPARE = 1.25


class Friction(NamedTuple):
    """What friction asks of the steps of a run; every entry is an array, so that it can be saved."""

    fastest: np.ndarray  # (1,) 1/s, largest damping / mass of a node since the last decision
    most: np.ndarray  # (1,) largest number of substeps of a step
    divided: np.ndarray  # (1,) steps that were divided


def begin() -> Friction:
    """At ignition."""
    return Friction(
        fastest=np.zeros(1), most=np.ones(1, dtype=np.int64), divided=np.zeros(1, dtype=np.int64)
    )


def most_damping(loop) -> float:
    """Friction damping / mass (1/s) of a node that the present step of a ``run.Loop`` can follow."""
    return max(0.0, 2.0 * (1.0 - _used(loop, loop.substeps)) / loop.step)


def needed(loop, damping: float) -> int:
    """Substeps that can follow ``damping`` (1/s); one more than ``MOST`` where those cannot."""
    step, count = loop.stepping.dt_s, 1
    while count <= MOST and not _used(loop, count) + 0.5 * damping * step / count <= 1.0:
        count += 1
    return count


def _used(loop, count: int) -> float:
    """Share of the stability condition that ``count`` substeps use, friction apart."""
    stepping = loop.stepping
    return used(stepping.dt_s / count, stepping.dt_limit_s, stepping.damping_ratio)


def present_damping(loop) -> float:
    """Largest friction damping / mass (1/s) of a node now."""
    return float(loop.state.loads["damping_rate"].max(initial=0.0))


def too_many(loop) -> bool:
    """Whether friction needs more than ``MOST`` substeps."""
    return needed(loop, present_damping(loop)) > MOST


def adapt(loop) -> int:
    """Divide the steps to come as friction requires; returns the number of steps until the next
    decision."""
    now, interval = present_damping(loop), _interval(loop)
    if now > most_damping(loop):
        _divide(loop, min(needed(loop, _SPARE * now), MOST))
        loop.friction.fastest[0] = now
    elif loop.substeps > 1 and loop.steps % interval == 0:
        fewer = needed(loop, _SPARE * max(now, loop.friction.fastest[0]))
        if fewer < loop.substeps:
            _divide(loop, fewer)
        loop.friction.fastest[0] = now
    loop.friction.most[0] = max(loop.friction.most[0], loop.substeps)
    return interval - loop.steps % interval if loop.substeps > 1 else loop.most + 1


def _divide(loop, count: int) -> None:
    """Go on with ``count`` substeps. The energy that the scheme conserves depends on its step, so
    the ledger gets the difference."""
    before = _kinetic_energy(loop)
    loop.set_stride(1, count)
    loop.state.work["released"] += before - _kinetic_energy(loop)


def _kinetic_energy(loop) -> np.ndarray:
    """Kinetic energy (J) by the scheme, all of it and the axial part (``TOTAL`` and ``AXIAL``)."""
    before = observe.moving(loop.now, loop.state)
    loop.kick(loop.step)
    after = observe.moving(loop.now, loop.state)
    observe.restore(loop.now, loop.state, before)
    return np.array(observe.kinetic_energy(loop.now, loop.state, before, after))


def _interval(loop) -> int:
    raster = raster_steps(loop.stepping, loop.scene.output.interval)
    return raster * max(1, STEPS_PER_CHECK // raster)


def note(loop, damping: float, steps: int) -> None:
    """Take note of ``steps`` just taken, with their largest ``damping`` (1/s)."""
    loop.friction.fastest[0] = max(loop.friction.fastest[0], damping)
    if loop.substeps > 1:
        loop.friction.divided[0] += steps


def cost(loop) -> dict[str, int]:
    """What friction cost: the largest number of substeps of a step, and how many steps were
    divided."""
    return {
        "friction_substeps": int(loop.friction.most[0]),
        "friction_divided_steps": int(loop.friction.divided[0]),
    }
