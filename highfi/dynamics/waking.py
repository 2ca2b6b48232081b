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
from tipoff.highfi.dynamics import jolts, observe, resting
from tipoff.highfi.dynamics.regroup import regroup
from tipoff.highfi.dynamics.resting import MOST_LEFT_OUT, Rails
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.state.threads import team_of
from tipoff.highfi.statics.inertial import TERMS
from tipoff.mechanics.ending import EXIT, PAST

_FAR = 4  # long steps before any pad can come near; fewer, and no long step begins


class Watch:
    """Follows the rails of one ``run.Loop``; evolving values are in the loop."""

    def __init__(self, system: System, rails: Rails):
        self.system, self.rails, self.alone = system, rails, team_of(1)
        self._views: dict[bytes, System] = {}

    def view(self, rests: np.ndarray) -> System:
        """The system while the rails ``rests`` (rails,) rest."""
        key = rests.tobytes()
        if key not in self._views:
            self._views[key] = resting.view(self.system, self.rails, rests)
        return self._views[key]

    def begin(self, loop) -> None:
        """Let rails rest at ignition, if no pad is near and no jolt of the platform excites
        them."""
        rails, active = self.rails, loop.active
        if not rails.at_ignition or self._jumps(loop):
            return
        if loop.now.frame is not None:
            self._note_rates(loop)
            loop.jolts.left_out[:] = jolts.largest(rails, np.abs(self._terms(loop)))
            if loop.jolts.left_out[0] > MOST_LEFT_OUT:
                return
        active.rests[:] = True
        self._look(loop)
        near = active.near.copy()
        active.rests[:] = False
        self._look(loop)
        self.regroup(loop, self._without(near, np.ones_like(loop.rests)))
        loop.state.work["released"] = 0.0  # the ledger begins here
        self._lengthen(loop)

    def adapt(self, loop) -> int:
        """Decide for the present step; returns the number of steps until the next decision."""
        near = loop.active.near
        if near.any():
            if loop.stride > 1:
                loop.set_stride(1)
                near[:] = False
            else:
                self.regroup(loop, self._without(near, loop.rests))
        elif loop.steps % self.rails.interval == 0:
            self._adapt(loop)
        return self.rails.interval - loop.steps % self.rails.interval

    def _adapt(self, loop) -> None:
        clear = 2.0 * FASTEST_SLIDE * loop.stepping.dt_s
        if loop.book[EXIT] < np.inf and loop.book[PAST] > clear:
            self.regroup(loop, np.ones_like(loop.rests))
        elif loop.now.frame is not None and loop.rests.any():
            if self._leaves_out(loop) > MOST_LEFT_OUT or self._jumps(loop):
                self.regroup(loop, np.zeros_like(loop.rests))
        if loop.stride > 1 and self._jumps(loop):
            loop.set_stride(1)
        self._lengthen(loop)

    def _without(self, near: np.ndarray, rests: np.ndarray) -> np.ndarray:
        """``rests`` without the rails that a pad of the groups ``near`` (g,) can touch."""
        return rests & ~np.asarray(self.rails.groups[:, near].any(axis=1))

    def _leaves_out(self, loop) -> float:
        """Vibration (m) that rails at rest leave out now."""
        found = loop.jolts
        before = found.rates.copy()
        span = self._note_rates(loop) - before[-1]
        if span > 0.0:
            amounts = jolts.terms(loop.system, before, found.rates, span)
            found.left_out[:] = jolts.follow(self.rails, found.modes, amounts, span)
        return float(found.left_out[0])

    def _note_rates(self, loop) -> float:
        """Store the motion of the platform of half a step ago; returns its time (s)."""
        rates = loop.jolts.rates
        rates[:-1] = jolts.rates(loop.now, loop.state)
        rates[-1] = loop.steps * loop.stepping.dt_s - 0.5 * loop.step
        return float(rates[-1])

    def _jumps(self, loop) -> bool:
        """Whether the thrust jumps before the next decision."""
        now, step = loop.steps, loop.stepping.dt_s
        jumps = self.rails.jumps
        return bool(((jumps >= now * step) & (jumps <= (now + self.rails.interval) * step)).any())

    def _lengthen(self, loop) -> None:
        """Take long steps if possible."""
        if not loop.rests.all() or loop.stride == self.rails.stride or self._jumps(loop):
            return
        if loop.substeps > 1:
            return
        if loop.system.model.interface_stiffness is not None:
            self._look(loop)
            loop.active.near[:] = False
            has_wall = loop.system.surface.search.wall >= 0
            if loop.active.wait[has_wall].min(initial=2**31) < _FAR * self.rails.stride:
                return
        loop.set_stride(self.rails.stride)

    def _look(self, loop) -> None:
        """Check all pads again. All rails must be at rest."""
        loop.active.near[:], loop.active.wait[:] = False, 0
        loop.evaluate()

    def _terms(self, loop) -> np.ndarray:
        """Present acceleration (TERMS,) of the rails' mounts."""
        if loop.now.frame is None:
            return np.zeros(TERMS)
        saved, step = observe.moving(loop.now, loop.state), loop.step
        before = jolts.rates(loop.now, loop.state)
        loop.kick(step)
        found = jolts.terms(loop.system, before, jolts.rates(loop.now, loop.state), step)
        observe.restore(loop.now, loop.state, saved)
        return found

    def regroup(self, loop, rests: np.ndarray) -> None:
        """Let the rails ``rests`` (rails,) rest and step all others, at the present platform motion."""
        if (loop.rests == rests).all():
            return
        loop.set_stride(1)
        if (loop.rests & ~rests).any():
            loop.jolts.most[:] = np.maximum(loop.jolts.most, loop.jolts.left_out)
        regroup(self.rails, loop, rests, self._terms(loop))
