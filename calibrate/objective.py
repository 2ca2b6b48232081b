"""Difference of the surrogate from the reference on all conditions, as one residual vector.

    J = 1/n sum_conditions [ L2(rate)^2 + (50 L2(v_x))^2 + (|dw_s| / |w_s,ref|)^2 ]

    L2(rate)^2 = sum_axes int |w - w_ref|^2 dt / sum_axes int |w_ref|^2 dt,  L2(v_x) likewise
    w_s: settled rates

Every term is relative to the condition's own amplitude. So a condition with small rates has the
same weight as one with large ones, and roll is weighted by its size and not by its noise. Rates are
required to 5 %, v_x to 0.1 %: the factor 50 makes both equally wrong, and makes the few mm/s of
friction visible. The settled rates are the result for the payload; a late contact has only a short
time in the integrals. J is rough: if a contact is just missed, everything after it jumps.
Amplitudes are at least a hundredth of the largest of all conditions: a fit to the rounding of a
condition without rates has no value.

A curve may be late: y(t) = f(t - offset), with one offset for each condition (``offsets``).
"""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
import scipy  # its submodules load at their first use

from tipoff import lowfi
from tipoff.calibration import alignment
from tipoff.calibration.faults import CalibrationError
from tipoff.calibration.parameters import Parameter, overrides
from tipoff.comparison.curves import Curves
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import changes as added
from tipoff.scenes.rail_compliance import model_of, of_scene
from tipoff.scenes.scene import Scene
from tipoff.scenes.variation import Variations

VELOCITY_WEIGHT = 50.0
SMALLEST_AMPLITUDE = 0.01
# relative error of a run that diverged, jammed or did not settle: above that of any other run
FAILED = 10.0


class Target(NamedTuple):
    """One condition of a fit."""

    scene: Scene
    time: np.ndarray  # (n,) s
    velocity: np.ndarray  # (n,) m/s, reference v_x
    rate: np.ndarray  # (n,3) rad/s
    settled: np.ndarray  # (3,) rad/s, settled rates
    weights: np.ndarray  # (n,) s, of the integrals
    amplitudes: tuple[float, float, float]  # sqrt(int v_x^2 dt), sqrt(int |w|^2 dt), |w_s|
    window_start: float  # s, of the settled window


def target(scene: Scene, reference: Curves) -> Target:
    """The target of a condition."""
    time, velocity, rate, settled = (
        reference.time,
        reference.velocity,
        reference.rate,
        reference.settled,
    )
    weights = np.gradient(time)
    weights[[0, -1]] *= 0.5  # the trapezoidal rule
    amplitudes = (
        float(np.sqrt(weights @ velocity**2)),
        float(np.sqrt(weights @ (rate**2).sum(axis=1))),
        float(np.linalg.norm(settled)),
    )
    return Target(
        scene=scene,
        time=time,
        velocity=velocity,
        rate=rate,
        settled=settled,
        weights=weights,
        amplitudes=amplitudes,
        window_start=reference.window_start,
    )


def targets(scene: Scene, references: dict[str, Curves]) -> dict[str, Target]:
    """Targets by condition, with small amplitudes raised. Raises CalibrationError if all velocities
    or all rates are zero."""
    found = {
        name: target(scene.condition(name), reference) for name, reference in references.items()
    }
    largest = np.max([item.amplitudes for item in found.values()], axis=0)
    if not (largest > 0.0).all():
        raise CalibrationError(
            f"cannot calibrate {scene.name}\n  references: all velocities or all rates are zero"
        )
    return {
        name: item._replace(
            amplitudes=tuple(np.maximum(item.amplitudes, SMALLEST_AMPLITUDE * largest))
        )
        for name, item in found.items()
    }


class Parts(NamedTuple):
    """Weighted residuals of one condition."""

    velocity: np.ndarray  # sum of squares: L2(v_x)^2, weighted
    rate: np.ndarray  # sum of squares: L2(rate)^2
    settled: np.ndarray  # sum of squares: relative settled error squared

    def vector(self) -> np.ndarray:
        """Residuals whose squared sum is the condition's share of J times n."""
        return np.concatenate([VELOCITY_WEIGHT * self.velocity, self.rate.ravel(), self.settled])


def sampled(result: Trajectory, time: np.ndarray) -> np.ndarray:
    """v_x (m/s) and rates (rad/s) of a run, (n,4), at times (n,); constant before ignition and
    after its end. Cubic between samples, so that a shift of time keeps the shape of a curve."""
    columns = np.column_stack([result.velocity[:, 0], result.rate])
    curve = scipy.interpolate.CubicSpline(result.time, columns)
    return curve(np.clip(time, result.time[0], result.time[-1]))


def compare(target: Target, result: Trajectory, offset: float = 0.0) -> Parts:
    """Residuals of a surrogate's run of the target's condition; its curves are late by ``offset``
    (s)."""
    root = np.sqrt(target.weights)
    moving, turning, leaving = target.amplitudes
    if result.status != "exited":
        share = np.full(target.time.size, 1.0 / np.sqrt(target.time.size))
        return Parts(
            share * FAILED / VELOCITY_WEIGHT,
            np.outer(share, np.full(3, FAILED / np.sqrt(3.0))),
            np.full(3, FAILED / np.sqrt(3.0)),
        )
    found = sampled(result, target.time - offset)
    velocity, rate = found[:, 0], found[:, 1:]
    return Parts(
        root * (velocity - target.velocity) / moving,
        root[:, None] * (rate - target.rate) / turning,
        (np.array(result.outcome.rate) - target.settled) / leaving,
    )


class Library(Protocol):
    """Receiver of the runs of a search, for the check of its curves."""

    def add(self, runs: dict[str, Trajectory], offsets: dict[str, float]) -> None:
        """Add the runs (by condition) of one point of the search."""


class Objective:
    """Residuals as a function of the parameters' shares (0..1 of their bounds); counts its
    evaluations.

    ``over`` applies a function to every condition, in order: ``map``, or that of a pool of threads,
    since the surrogate's kernels release the interpreter lock. Both give the same bits. Runs use
    compliant contact with a rail ``compliance``, springs without one or, if the rails are warm,
    with a rigid one.
    """

    def __init__(
        self,
        scene: Scene,
        targets: dict[str, Target],
        parameters: list[Parameter],
        numerics=None,
        over: Callable = map,
        compliance: RailCompliance | None = None,
    ):
        self.model = model_of(scene, compliance)
        self.scene, self.targets, self.parameters = scene, targets, parameters
        # a number of modes that changes between trials would make the objective jump
        self.numerics, self.over, self.compliance = (
            numerics or lowfi.Numerics(modes=0),
            over,
            compliance,
        )
        self.variations = {name: Variations(wanted.scene) for name, wanted in targets.items()}
        self.offsets = dict.fromkeys(targets, 0.0)
        self.library: Library | None = None
        self.evaluations = 0
        self._last: tuple[bytes, dict[str, Trajectory]] | None = None

    def values(self, shares: np.ndarray) -> dict[str, float]:
        """Values (SI) of the parameters by name."""
        return {
            item.name: item.value(float(share))
            for item, share in zip(self.parameters, shares, strict=True)
        }

    def runs(self, shares: np.ndarray) -> dict[str, Trajectory]:
        """The surrogate's runs by condition. The last runs are kept, because a changed offset needs
        no new run."""
        if self._last is not None and self._last[0] == shares.tobytes():
            return self._last[1]
        self.evaluations += 1
        values = self.values(shares)
        constants, changes = overrides(self.scene, values), alignment.changes(values)
        if self.compliance is not None and self.model == COMPLIANT:
            of_scene(self.compliance, self.scene.replace(constants))  # once, not in each thread

        def one(name: str) -> Trajectory:
            change = added.overrides(self.targets[name].scene, changes)
            return self.alone(self.variations[name].of(constants | change))

        found = dict(zip(self.targets, self.over(one, self.targets)))
        self._last = (shares.tobytes(), found)
        if self.library is not None:
            self.library.add(found, self.offsets)
        return found

    def alone(self, scene: Scene) -> Trajectory:
        """A run of a ``scene`` of a condition, with the model and numerics of the objective."""
        return lowfi.run(scene, self.model, numerics=self.numerics, compliance=self.compliance)

    def parts(self, shares: np.ndarray) -> dict[str, Parts]:
        """Residuals by condition, of curves that are late by ``offsets`` (s)."""
        return {
            name: compare(self.targets[name], run, self.offsets[name])
            for name, run in self.runs(shares).items()
        }

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        """Residual vector r with J = r'r."""
        return self.joined(self.parts(shares))

    def joined(self, parts: dict[str, Parts]) -> np.ndarray:
        """Residual vector of the ``parts`` of all conditions."""
        return np.concatenate([part.vector() for part in parts.values()]) / np.sqrt(len(parts))

    def curves(self, parts: dict[str, Parts]) -> list[np.ndarray]:
        """Differences (n,) of v_x (m/s) and of each rate (rad/s), four curves per condition."""
        found = []
        for name, part in parts.items():
            wanted = self.targets[name]
            root, (moving, turning, _) = np.sqrt(wanted.weights), wanted.amplitudes
            found += [part.velocity * moving / root, *(part.rate * turning / root[:, None]).T]
        return found
