"""Draws from a density on the unit cube by an ensemble of walkers, and whether they may be trusted.

Walkers move along differences of each other (ter Braak, Stat. Comput. 16, 2006, 239; ter Braak and Vrugt, Stat. Comput. 18,
2008, 435; emcee, Foreman-Mackey et al., PASP 125, 2013, 306), so no scale has to be told beforehand and a jump of the density does
no harm. The first quarter is dropped. The rest counts as ``walkers * steps / tau`` independent draws, tau the integrated
autocorrelation time, an estimate that needs 50 tau of steps to be trusted (Sokal; emcee's own rule). Until then, or the most steps
allowed, walkers go on.
"""

from typing import Callable, NamedTuple

import numpy as np

DROPPED = 0.25
LENGTHS = 50.0  # of tau, from which on its estimate holds
ACCEPTED = (0.1, 0.9)  # below, walkers are stuck; above, they hardly move
_LOOK = 100  # steps between two looks at convergence


class Plan(NamedTuple):
    """``walkers``, at least twice the parameters; at most ``steps`` of each, at least ``least``."""

    walkers: int = 12
    steps: int = 2600
    least: int = 400


class Chain(NamedTuple):
    """What is kept: draws (n,walkers,p) of shares and their log density (n,walkers); over the kept part share of moves accepted and
    autocorrelation times (p,) in steps; steps done; and why it is not to be trusted, in words, or nothing."""

    shares: np.ndarray
    density: np.ndarray
    accepted: float
    autocorrelation: np.ndarray
    steps: int
    doubts: list[str]

    @property
    def effective(self) -> float:
        """Number of independent draws, of the parameter that has the fewest."""
        return self.density.size / float(np.max(self.autocorrelation))


def sample(density: Callable[[np.ndarray], float], start: np.ndarray, plan: Plan, seed: int,
           progress: Callable[[float], None] | None = None) -> Chain:
    """Draw from ``density``, a log density of shares (p,), uniform prior on the unit cube included, from ``start`` (walkers,p).

    The same seed gives the same bits; ``progress`` is called with the fraction of the steps allowed.
    """
    import emcee  # an extra, wanted here alone

    def bounded(shares: np.ndarray) -> float:
        inside = (shares >= 0.0).all() and (shares <= 1.0).all()
        return density(shares) if inside else -np.inf

    walkers, count = start.shape
    kinds = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]
    sampler = emcee.EnsembleSampler(walkers, count, bounded, moves=kinds)
    sampler.random_state = np.random.RandomState(seed).get_state()
    moves, before = [], np.zeros(walkers)
    for step, _ in enumerate(sampler.sample(start, iterations=plan.steps), start=1):
        moves.append(sampler.backend.accepted - before)
        before = sampler.backend.accepted.copy()
        if progress:
            progress(step / plan.steps)
        if step >= plan.least and step % _LOOK == 0 and not _judged(sampler, moves, step).doubts:
            break
    if progress:
        progress(1.0)
    return _judged(sampler, moves, step)


def _judged(sampler, moves: list[np.ndarray], steps: int) -> Chain:
    from emcee.autocorr import integrated_time

    first = int(DROPPED * steps)
    shares, density = sampler.get_chain(discard=first), sampler.get_log_prob(discard=first)
    moved = np.ptp(shares, axis=0).min(axis=0) > 0.0  # a walker that stands still has no autocorrelation
    times = np.full(shares.shape[2], float(len(shares)))
    if moved.any():
        times[moved] = np.maximum(1.0, integrated_time(shares[:, :, moved], quiet=True, tol=0))
    accepted = float(np.mean(moves[first:]))
    return Chain(shares, density, accepted, times, steps, _doubts(len(shares), float(times.max()), accepted))


def _doubts(kept: int, longest: float, accepted: float) -> list[str]:
    found = []
    if kept < LENGTHS * longest:
        found.append(f"{kept} steps are {kept / longest:.0f} autocorrelation times of {longest:.0f} steps, fewer than "
                     f"{LENGTHS:.0f}")
    if not ACCEPTED[0] <= accepted <= ACCEPTED[1]:
        low, high = (100.0 * share for share in ACCEPTED)
        found.append(f"{100.0 * accepted:.0f} % of the moves were accepted, expected {low:.0f} to {high:.0f} %")
    return found
