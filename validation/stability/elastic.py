"""Hard cases of the finite-element reference, on the coarse mesh of the catalogue scene
``tiny``."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from tipoff.scenes.scene import Scene, load
from tipoff.studies.agreement.verdicts import settled_change
from validation.stability import weaker_methods as weaker
from validation.stability.verdict import Control, Measure, Stability, Verdict, verdict

_SIZE = 0.016


def _scene() -> Scene:
    return load("tiny").condition("phi60")


class _Rail:
    """The linear rail without contact: accelerations, and a start bent like a loaded beam."""

    def __init__(self):
        from tipoff import highfi
        from tipoff.highfi.statics import assembly, stable_step

        scene = _scene()
        material = scene.rail.material
        mesh = highfi.prepare(scene, highfi.Numerics(element_size=_SIZE))
        self.operator = assembly.of_material(mesh, material)
        self.stiffness = assembly.sparse(self.operator)
        self.mass = np.repeat(self.operator.mass, 3)
        self.free = np.repeat(self.operator.free, 3)
        self.limit = stable_step.critical_step(stable_step.operator_bound(self.operator).upper)
        self.start = np.zeros(self.mass.size)
        self.start[1::3] = 1e-5 * np.sin(
            np.pi * (mesh.points[:, 0] - mesh.points[:, 0].min()) / np.ptp(mesh.points[:, 0])
        )
        self.start[~self.free] = 0.0

    def acceleration(self, _, x, __):
        return np.where(self.free, -(self.stiffness @ x) / self.mass, 0.0)

    def leapfrog(self, step: float, count: int) -> tuple[float, float]:
        """Largest displacement over that of the start, and relative change of the energy, after
        ``count`` central differences.

        The scheme's own invariant is v' M v / 2 + x(n)' K x(n+1) / 2 with v between the two.
        """
        x, v = self.start, -0.5 * step * self.acceleration(0.0, self.start, None)
        v = v + step * self.acceleration(0.0, x, None)
        first = self._energy(x, x + step * v, v)
        with np.errstate(over="ignore", invalid="ignore"):
            x, v = weaker.semi_implicit_euler(self.acceleration, x + step * v, v, step, count)
            growth = float(np.abs(x).max() / np.abs(self.start).max())
            return growth, abs(self._energy(x - step * v, x, v) / first - 1.0)

    def euler(self, step: float, count: int) -> float:
        """Relative change of the energy by the explicit Euler method."""
        x, v = weaker.explicit_euler(self.acceleration, self.start, 0.0 * self.start, step, count)
        return abs(self._energy(x, x, v) / self._energy(self.start, self.start, 0.0 * v) - 1.0)

    def _energy(self, before, after, v) -> float:
        return float(0.5 * (before @ (self.stiffness @ after) + self.mass @ v**2))


def step_above_the_limit() -> Verdict:
    """Steps 0.1 %, 1 % and 100 % above the limit are refused. A loop without this check diverges."""
    from tipoff import highfi
    from tipoff.highfi.statics.stable_step import StepError

    rail, scene, refused = _Rail(), _scene().replace({"contact": None}), []
    for factor in (1.001, 1.01, 2.0):
        try:
            highfi.run(
                scene.replace({"duration": 1e-4}),
                highfi.Numerics(element_size=_SIZE, step=factor * rail.limit),
            )
        except StepError as fault:
            refused.append(str(fault))
    return verdict(
        "step above the critical one",
        "highfi",
        Measure(
            "growth of the displacement over 400 steps at 0.9 of the limit",
            rail.leapfrog(0.9 * rail.limit, 400)[0],
            10.0,
        ),
        Control(
            "the same loop, unchecked, at 1.05 x the limit",
            rail.leapfrog(1.05 * rail.limit, 400)[0],
        ),
        f"{len(refused)} of 3 longer steps refused",
        holds=len(refused) == 3,
        stable=Stability(0.9 * rail.limit, rail.limit),
    )


def long_vibration() -> Verdict:
    """A vibrating rail over 20,000 steps: central differences keep its energy. Explicit Euler, at
    the same cost, does not."""
    rail = _Rail()
    step = 0.9 * rail.limit
    drift = rail.leapfrog(step, 20000)[1]
    return verdict(
        "ringing rail, 20,000 steps",
        "highfi",
        Measure("relative change of the energy", drift, 1e-9),
        Control("explicit Euler, same step, 50 steps", rail.euler(step, 50)),
        stable=Stability(step, rail.limit, drift),
    )


def sliding_over_facets() -> Verdict:
    """Pads slide over facets half their size: the rates must not depend on the number of contact
    cells."""
    from tipoff import highfi

    scene, choices = (
        _scene(),
        [highfi.Numerics(element_size=0.008, cells=cells) for cells in (32, None, 2)],
    )
    highfi.prepare(scene, choices[0])
    with ThreadPoolExecutor() as pool:
        fine, usual, poor = pool.map(
            lambda numerics: highfi.run(scene, numerics, threads=1), choices
        )
    ours, theirs = settled_change(fine, usual), settled_change(fine, poor)
    assert ours is not None and theirs is not None  # all three runs leave their rail
    return verdict(
        "pads slide over facet borders",
        "highfi",
        Measure("settled rates against 32 x 32 contact cells per face (deg/s)", ours, 0.1),
        Control("2 x 2 contact cells per face", theirs),
        stable=Stability(
            usual.cost["dt_s"], usual.cost["dt_limit_s"], usual.checks["energy_error"]
        ),
    )


CASES = {
    "step_above_the_limit": step_above_the_limit,
    "long_vibration": long_vibration,
    "sliding_over_facets": sliding_over_facets,
}
