"""Rules for rails at rest: when a rail rests, when it is stepped again, and when all bodies take
long steps.

A rail at rest is stepped again before a pad can touch it, within two steps at
``pads.FASTEST_APPROACH``. On a free platform it is also stepped again when more vibration than
``MOST_LEFT_OUT`` is left out, and before the thrust jumps. Rails rest again after the payload has
left them. While all rails rest and all pads are far from them, nothing is stiff, and a step is
``Rails.stride`` steps long.

Decisions must not depend on the sampling interval: they are taken at multiples of
``step_size.RASTER``, and at the step at which a pad comes near.
"""

import numpy as np

from tipoff.highfi.contact.pads import FASTEST_SLIDE
from tipoff.highfi.dynamics import jolts, observe
from tipoff.highfi.dynamics.regroup import regroup
from tipoff.highfi.dynamics.resting import MOST_LEFT_OUT, Rails
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.statics.inertial import TERMS
from tipoff.mechanics.books import EXIT, PAST

_FAR = 4  # long steps before any pad can come near; fewer, and no long step begins


def begin(rails: Rails, stepper: Stepper) -> None:
    """Let rails rest at ignition, if no pad is near and no jolt of the platform excites them."""
    active, found = stepper.active, stepper.jolts
    if not rails.at_ignition or _jumps(rails, stepper):
        return
    if stepper.now.frame is not None:
        _note_rates(stepper)
        found.left_out[:] = jolts.largest(rails, np.abs(_terms(stepper)))
        if found.left_out[0] > MOST_LEFT_OUT:
            return
    active.rests[:] = True
    _look(stepper)
    near = active.near.copy()
    active.rests[:] = False
    _look(stepper)
    let_rest(rails, stepper, _without(rails, near, np.ones_like(stepper.rests)))
    stepper.state.work["released"] = 0.0  # the ledger begins here
    _lengthen(rails, stepper)


def adapt(rails: Rails, stepper: Stepper) -> int:
    """Decide for the present step; returns the number of steps until the next decision."""
    near, interval = stepper.active.near, stepper.setup.interval
    if near.any():
        if stepper.stride > 1:
            stepper.set_stride(1)
            near[:] = False
        else:
            let_rest(rails, stepper, _without(rails, near, stepper.rests))
    elif stepper.steps % interval == 0:
        _adapt(rails, stepper)
    return interval - stepper.steps % interval


def _adapt(rails: Rails, stepper: Stepper) -> None:
    clear = 2.0 * FASTEST_SLIDE * stepper.setup.stepping.dt_s
    if stepper.book[EXIT] < np.inf and stepper.book[PAST] > clear:
        let_rest(rails, stepper, np.ones_like(stepper.rests))
    elif stepper.now.frame is not None and stepper.rests.any():
        if _leaves_out(rails, stepper) > MOST_LEFT_OUT or _jumps(rails, stepper):
            let_rest(rails, stepper, np.zeros_like(stepper.rests))
    if stepper.stride > 1 and _jumps(rails, stepper):
        stepper.set_stride(1)
    _lengthen(rails, stepper)


def _without(rails: Rails, near: np.ndarray, rests: np.ndarray) -> np.ndarray:
    """``rests`` without the rails that a pad of the groups ``near`` (g,) can touch."""
    return rests & ~np.asarray(rails.groups[:, near].any(axis=1))


def _leaves_out(rails: Rails, stepper: Stepper) -> float:
    """Vibration (m) that rails at rest leave out now."""
    found = stepper.jolts
    before = found.rates.copy()
    span = _note_rates(stepper) - before[-1]
    if span > 0.0:
        amounts = jolts.terms(stepper.setup.system, before, found.rates, span)
        found.left_out[:] = jolts.follow(rails, found.modes, amounts, span)
    return float(found.left_out[0])


def _note_rates(stepper: Stepper) -> float:
    """Store the motion of the platform of half a step ago; returns its time (s)."""
    now, state, found = stepper.now, stepper.state, stepper.jolts.rates
    found[:-1] = jolts.rates(now, state, observe.moving(state))
    found[-1] = stepper.time - 0.5 * stepper.step
    return float(found[-1])


def _jumps(rails: Rails, stepper: Stepper) -> bool:
    """Whether the thrust jumps before the next decision."""
    now, setup, jumps = stepper.steps, stepper.setup, rails.jumps
    step = setup.stepping.dt_s
    return bool(((jumps >= now * step) & (jumps <= (now + setup.interval) * step)).any())


def _lengthen(rails: Rails, stepper: Stepper) -> None:
    """Take long steps if possible."""
    if not stepper.rests.all() or stepper.stride == rails.stride or _jumps(rails, stepper):
        return
    if stepper.substeps > 1:
        return
    system, active = stepper.setup.system, stepper.active
    if system.model.interface_stiffness is not None:
        _look(stepper)
        active.near[:] = False
        has_wall = system.surface.search.wall >= 0
        if active.wait[has_wall].min(initial=2**31) < _FAR * rails.stride:
            return
    stepper.set_stride(rails.stride)


def _look(stepper: Stepper) -> None:
    """Check all pads again. All rails must be at rest."""
    stepper.active.near[:], stepper.active.wait[:] = False, 0
    stepper.evaluate()


def _terms(stepper: Stepper) -> np.ndarray:
    """Present acceleration (TERMS,) of the rails' mounts."""
    now, state = stepper.now, stepper.state
    if now.frame is None:
        return np.zeros(TERMS)
    before, after = (jolts.rates(now, state, moving) for moving in stepper.moving())
    return jolts.terms(stepper.setup.system, before, after, stepper.step)


def let_rest(rails: Rails, stepper: Stepper, rests: np.ndarray) -> None:
    """Let the rails ``rests`` (rails,) rest and step all others, at the present platform motion."""
    if (stepper.rests == rests).all():
        return
    stepper.set_stride(1)
    if (stepper.rests & ~rests).any():
        stepper.jolts.most[:] = np.maximum(stepper.jolts.most, stepper.jolts.left_out)
    regroup(rails, stepper, rests, _terms(stepper))
