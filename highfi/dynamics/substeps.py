"""Substeps: parts of a step, used while friction damps nodes too fast for a whole step.

Friction near rest is a damper mu' N at each contact, and the nodes of a fine mesh are light. So a
payload at rest on its rails damps them faster than any sliding contact (``step_limit`` has the
condition). All nodes and bodies then take substeps. The elastic force stays the same in them, so a
run becomes more expensive; its ``cost`` has their number.

A whole step still ends at the same time, so the times of samples stay. The kernel returns after the
step in which the damping exceeds the limit. The number of substeps is reduced only at multiples of
``step_size.RASTER``, so the sampling interval changes no bit of the result.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics import observe
from tipoff.highfi.dynamics.step_limit import used
from tipoff.highfi.dynamics.step_size import STEPS_PER_CHECK, raster_steps

MOST = 1000  # substeps of a step
# Ratio of the damping that chooses the substeps to the present one, so that growing contact does
# not change them repeatedly.
_SPARE = 1.25


class Friction(NamedTuple):
    """Friction damping and substeps of a run. Every entry is an array, so that it can be saved."""

    fastest: np.ndarray  # (1,) 1/s, largest damping / mass of a node since the last decision
    most: np.ndarray  # (1,) largest number of substeps of a step
    divided: np.ndarray  # (1,) number of divided steps


def begin() -> Friction:
    """At ignition."""
    return Friction(
        fastest=np.zeros(1), most=np.ones(1, dtype=np.int64), divided=np.zeros(1, dtype=np.int64)
    )


def most_damping(loop) -> float:
    """Limit of friction damping / mass (1/s) of a node for the present step of a ``run.Loop``."""
    return max(0.0, 2.0 * (1.0 - _used(loop, loop.substeps)) / loop.step)


def needed(loop, damping: float) -> int:
    """Number of substeps for ``damping`` (1/s); ``MOST`` + 1 if ``MOST`` are not sufficient."""
    step, count = loop.stepping.dt_s, 1
    while count <= MOST and not _used(loop, count) + 0.5 * damping * step / count <= 1.0:
        count += 1
    return count


def _used(loop, count: int) -> float:
    """Share of the stability condition that ``count`` substeps use, without friction."""
    stepping = loop.stepping
    return used(stepping.dt_s / count, stepping.dt_limit_s, stepping.damping_ratio)


def present_damping(loop) -> float:
    """Largest friction damping / mass (1/s) of a node now."""
    return float(loop.state.loads["damping_rate"].max(initial=0.0))


def too_many(loop) -> bool:
    """Whether friction needs more than ``MOST`` substeps."""
    return needed(loop, present_damping(loop)) > MOST


def adapt(loop) -> int:
    """Divide the next steps as friction requires; returns the number of steps until the next
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
    """Continue with ``count`` substeps. The energy that the scheme conserves depends on its step,
    so the ledger gets the difference."""
    before = _kinetic_energy(loop)
    loop.set_stride(1, count)
    loop.state.work["released"] += before - _kinetic_energy(loop)


def _kinetic_energy(loop) -> np.ndarray:
    """Kinetic energy (J) of the scheme: total and axial part (``TOTAL`` and ``AXIAL``)."""
    before = observe.moving(loop.now, loop.state)
    loop.kick(loop.step)
    after = observe.moving(loop.now, loop.state)
    observe.restore(loop.now, loop.state, before)
    return np.array(observe.kinetic_energy(loop.now, loop.state, before, after))


def _interval(loop) -> int:
    raster = raster_steps(loop.stepping, loop.scene.output.interval)
    return raster * max(1, STEPS_PER_CHECK // raster)


def note(loop, damping: float, steps: int) -> None:
    """Record the last ``steps`` with their largest ``damping`` (1/s)."""
    loop.friction.fastest[0] = max(loop.friction.fastest[0], damping)
    if loop.substeps > 1:
        loop.friction.divided[0] += steps


def cost(loop) -> dict[str, int]:
    """Largest number of substeps of a step, and number of divided steps."""
    return {
        "friction_substeps": int(loop.friction.most[0]),
        "friction_divided_steps": int(loop.friction.divided[0]),
    }
