"""Stage ``ripple``: ripple of the contact force at the facet frequency, at which a pad crosses the rail facets.

A constant load presses the payload into a corner of the rails; the payload comes to rest and then
slides along the rails without friction at a constant speed v. The walls are straight, so the force
of a face at v / h and its multiples, h the length of a facet, comes from elements and
contact cells alone::

    ripple = 2 |sum of w (F - trend) exp(-2 pi i k v t / h)| / (sum of w  mean F),   w Hann's window, k = 1 .. HARMONICS

Physical changes are slower: bolts and rail ends pass in ten facets and more, the payload bounces at
some hundred Hz. The same sum half-way between the multiples shows the leakage of these and of the
ringing rail.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from tipoff.highfi import Numerics, prepare
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.simulation import Loop
from tipoff.highfi.state.threads import processors
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.scenes.scene import Scene
from tipoff.studies.render.column import Column
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

_FEW_CELLS = 3  # along each edge of a pad: cells longer than the facets
HARMONICS = 3
_SPEED = 6.0  # m/s: the payload cannot follow so fast a passing facet
_LOAD = 1000.0  # N
_INTERVAL = 2e-5  # s
# samples of the settling, and the factor on all velocities after each: about critical damping
_SETTLING, _KEPT = 400, 0.95
LEAST_FACETS = 5  # facets crossed at least
_TREND = 5  # degree of the polynomial for the slow part of a force
_EVEN = 1e-3  # largest relative difference of facet lengths
_FRICTIONLESS = {"static": 1e-9, "dynamic": 1e-9, "static_speed": 0.01, "dynamic_speed": 0.02}


@dataclass(frozen=True)
class Ripple:
    """``ripple`` (1) of the face with the largest one, ``background`` (1) half-way between the
    multiples; ``frequency`` (Hz) of the first multiple, ``facets`` crossed, ``load`` (N) of that
    face, ``cells_per_edge`` of a pad."""

    ripple: Annotated[float, Column("ripple", "%", ".2g", 100.0)]
    background: Annotated[float, Column("between multiples", "%", ".2g", 100.0)]
    frequency: Annotated[float, Column("facet frequency", "Hz", ".4g")]
    facets: Annotated[int, Column("facets")]
    load: float
    # ``judge`` does not know it
    cells_per_edge: Annotated[int, Column("contact cells along each edge of a pad")] = 0


@dataclass(frozen=True, kw_only=True)
class Slide(Ripple):
    """Ripple on a mesh."""

    element_size_m: Annotated[float, Column("element size", "mm", "g", 1e3)]


@dataclass(frozen=True)
class Ripples:
    """``rows``: the coarse mesh with few contact cells and with its own, and the mesh of the study;
    empty without contact."""

    condition: str
    rows: tuple[Slide, ...]


def run(study: Study) -> Made[Ripples]:
    """Ripple on the rails of the first refined condition, or else of the first condition."""
    name = (study.scene.agreement.refined or tuple(study.conditions))[0]
    coarse, size = study.settings.coarse_size, study.settings.element_size

    def make() -> tuple[Ripples, list[Path]]:
        found = [
            (size, measure(study.condition(name), Numerics(element_size=size, cells=cells)))
            for size, cells in ((coarse, _FEW_CELLS), (coarse, None), (size, None))
        ]
        slides = (Slide(element_size_m=size, **vars(own)) for size, own in found if own)
        return Ripples(name, tuple(slides)), []

    return STAGE.run(study, None, make)


STAGE = Stage("ripple", __name__, result=Ripples)


def measure(scene: Scene, numerics: Numerics) -> Ripple | None:
    """Ripple on the rails of ``scene``; None without contact, with facets of different lengths, or
    with too few facets."""
    if scene.contact is None:
        return None
    pressed = pressing(scene)
    mesh = prepare(pressed, numerics)
    length = facet_length(mesh)
    system = build(pressed, numerics, mesh)
    if not length:
        return None
    facets = int((pressed.rail.end - leading_edge(system.faces)) / length)
    if facets < LEAST_FACETS:
        return None
    loop = Loop(set_up(pressed, system, choose(system, pressed, numerics), processors()))
    force = slide(loop, round(facets * length / _SPEED / _INTERVAL))
    cells = int(system.surface.cells[:, 0].max())
    return replace(judge(force, _SPEED / length, facets), cells_per_edge=cells)


def pressing(scene: Scene) -> Scene:
    """``scene`` with a load into the +y and +z walls, which the pads just touch, and no other load.
    Its effects stay, because another set of effects compiles another kernel."""
    assert scene.contact is not None  # required by ``measure``
    _, beside, above = scene.contact.gaps()
    changes = {
        "thrust": {"kind": "gaussian", "peak": _LOAD, "width": 1e4, "centre": 0.0, "arm": 1e-6},
        "mass_offset": None,
        "thrust_offset": {"misalignment": {"axial": np.pi / 2.0, "radial": np.pi / 4.0}},
        "duration": 1.0,
        "initial": {"position": {"y": beside, "z": above}},
        **{effect.key: None for effect in EFFECTS if effect.is_body_force},
        "output.interval": _INTERVAL,
    }
    return scene.replace(changes | ({"friction": _FRICTIONLESS} if scene.friction else {}))


def facet_length(mesh) -> float | None:
    """Length (m) along X of the contact facets, or None if the lengths differ."""
    facets = np.concatenate(
        [group for name, group in mesh.surfaces.items() if name.startswith("contact")]
    )
    lengths = np.ptp(mesh.points[facets][:, :, 0], axis=1)
    return float(lengths.mean()) if np.ptp(lengths) <= _EVEN * lengths.mean() else None


def leading_edge(faces) -> float:
    """X (m) of the foremost edge of a pad at ignition."""
    return float((faces.centre[:, 0] + faces.half_length).max())


def slide(loop: Loop, samples: int) -> np.ndarray:
    """Forces (n,f,3) N on the faces while the payload slides, after it came to rest under its
    load."""
    state = loop.stepper.state
    loop.begin()
    for _ in range(_SETTLING):
        _advance(loop)
        for moving in (
            state.velocity,
            state.rail_momentum,
            *state.payload[1::2],
            *state.platform[1::2],
        ):
            moving *= _KEPT
    state.payload.velocity[0] += _SPEED
    first = len(loop.recorded.forces)
    for _ in range(samples):
        _advance(loop)
    return np.array(loop.recorded.forces[first:])


def _advance(loop: Loop) -> None:
    """Advance by one sample. The settling loses energy on purpose, so messages are cleared. Raises
    FloatingPointError if a value becomes infinite."""
    taken = len(loop.recorded.rows)
    while len(loop.recorded.rows) == taken:
        loop.recorded.message = ""
        loop.advance_one_sample()
        if not np.isfinite(loop.stepper.state.payload.velocity).all():
            raise FloatingPointError("the sliding payload has no finite velocity any more")


def judge(force: np.ndarray, frequency: float, facets: int) -> Ripple:
    """Ripple of forces (n,f,3) N at the multiples of ``frequency`` (Hz), over faces with at least a
    tenth of the largest load."""
    mean = np.linalg.norm(force.mean(axis=0), axis=1)
    loaded = np.flatnonzero(mean > 0.1 * mean.max())
    sizes = np.linalg.norm(force[:, loaded], axis=2)
    multiples = np.arange(1, HARMONICS + 1)
    at, between = (
        amplitudes(sizes, frequency * which) / mean[loaded]
        for which in (multiples, multiples + 0.5)
    )
    worst = int(at.max(axis=0).argmax())
    return Ripple(
        float(at.max()),
        float(between.max()),
        frequency=frequency,
        facets=facets,
        load=float(mean[loaded[worst]]),
    )


def amplitudes(values: np.ndarray, frequencies: np.ndarray) -> np.ndarray:
    """Amplitudes (k,f) at ``frequencies`` (k,) Hz of samples (n,f) without their trend."""
    place = np.linspace(-1.0, 1.0, len(values))
    rest = (
        values
        - np.polynomial.polynomial.polyval(
            place, np.polynomial.polynomial.polyfit(place, values, _TREND)
        ).T
    )
    window = np.hanning(len(values))
    turning = np.exp(-2j * np.pi * np.outer(frequencies, _INTERVAL * np.arange(len(values))))
    return 2.0 * np.abs((turning * window) @ rest) / window.sum()
