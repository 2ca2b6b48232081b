"""Both records beside runs of several models, by the quantities of ``tipoff measured``.

A run is turned by the unknown angle between rail and sensor.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff import highfi, lowfi
from tipoff.mechanics.estimates import pin
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import scene_model
from tipoff.scenes.scene import Scene
from tipoff.studies.measured.launch.quantities import (
    BY_SIZE,
    LATERAL,
    SPEED,
    TIME,
    ComparedValue,
    Stated,
    blurred,
    impacts,
    over_frequency,
    over_way,
    rate_name,
    table,
)
from tipoff.workspace.progress import say
from validation.flights import launchers, record
from validation.flights.launchers import HEDY, PSAS, Variant
from validation.flights.record import Flown

ELEMENT = 20e-3  # m
MODES = 8  # as the studies of rocket_rail
NO_PLAY = 1e-6  # m on each side
MODELS = ("compliant", "no play", "springs", "pin")
BANDS = {PSAS.name: (5.0, 25.0, 60.0, 150.0, 400.0), HEDY.name: (3.0, 8.0, 16.0, 30.0, 50.0)}  # Hz
# deg/s between samples in turn: above six times the scatter of differences after the exit
JUMP = {PSAS.name: 15.0, HEDY.name: 15.0}


def quantities(own: Flown, rate: np.ndarray) -> dict[str, float]:
    """Rattling in rates (n,3) rad/s at the instants of the record: root mean squares over the way and in bands of
    frequency, deg/s, and jumps."""
    found: dict[str, float] = {}
    for kind in BY_SIZE.items():
        found |= over_way(own, rate, dict([kind]))
        found |= over_frequency(own, rate, dict([kind]), BANDS[own.launcher.name])
    return found | impacts(own, rate, JUMP[own.launcher.name])


def measured(own: Flown) -> dict[str, Stated]:
    """Each quantity of the record and its uncertainty, None where the noise is in the predictions."""
    rate, spread, slope = own.line()
    bias = own.rest_noise / math.sqrt(_independent(own))
    spread = np.degrees(np.hypot(np.hypot(spread, slope * own.half), bias))
    rate = np.degrees(rate)
    speed, change = own.at_exit(own.speed)
    scale = record.SCALE[own.launcher.name]
    found = {
        TIME: Stated(own.left, own.half),
        SPEED: Stated(speed, math.hypot(change, scale * speed)),
    }
    for axis, name in enumerate("xyz"):
        found[rate_name(name)] = Stated(float(rate[axis]), float(spread[axis]))
    across = math.hypot(rate[1], rate[2])
    found[LATERAL] = Stated(across, float(np.hypot(*spread[1:]) / math.sqrt(2)))
    for name, value in quantities(own, own.rate).items():
        found[name] = Stated(value)
    return found


def _independent(own: Flown) -> float:
    """Independent samples at rest, not above one each 50 ms: shaking has periods of some tens of ms."""
    first, last = record.REST[own.launcher.name]
    return max(2.0, (last - first) / 0.05)


def predicted(
    own: Flown, run: Trajectory, draw: dict[str, float], seed: int
) -> tuple[dict[str, float], np.ndarray]:
    """The same quantities of a run, and its rates (n,3) rad/s at the instants of the record, with noise."""
    clean = np.column_stack([np.interp(own.time, run.time, one) for one in run.rate.T])
    clean[own.time < 0.0] = 0.0
    outcome = run.outcome
    assert outcome.exit_time is not None and outcome.exit_velocity and outcome.exit_rate
    turn = _turn(draw["orientation"])
    return _with_noise(
        own,
        clean @ turn.T,
        (outcome.exit_time, outcome.exit_velocity[0]),
        turn @ outcome.exit_rate,
        seed,
    )


def _turn(degrees: float) -> np.ndarray:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])


def _with_noise(
    own: Flown, clean: np.ndarray, left: tuple[float, float], at_exit: np.ndarray, seed: int
) -> tuple[dict[str, float], np.ndarray]:
    generator = np.random.default_rng(seed)
    found = blurred(measured(own), left, at_exit, generator)
    return found | quantities(own, clean + own.shaken(generator)), clean


def pinned(
    own: Flown, scene: Scene, variant: Variant, draw: dict[str, float], seed: int
) -> dict[str, float]:
    """The quantities of a rigid rocket on a pin (``tipoff.mechanics.estimates.pin``), its rear guide, after the front
    one has left."""
    travel = own.launcher.rail - variant.foot
    leaves = [
        float(np.interp(way, own.way, own.time))
        for way in (travel - variant.front + variant.rear, travel)
    ]
    time, force = leaves[1] - leaves[0], float(np.interp(own.left, *record.thrust(own).T))
    model = scene_model.build(scene.replace(launchers.changes(own.launcher, draw)))
    turn = _turn(draw["orientation"])
    rate = turn @ pin.rates(model, -variant.rear, force * time, time)
    share = np.clip((own.time - leaves[0]) / time, 0.0, 1.0)[:, None]
    speed = float(np.interp(leaves[1], own.time, own.speed))
    return _with_noise(own, share * rate, (leaves[1], speed), rate, seed)[0]


@dataclass
class Flight:
    """The comparison of a launch. ``band`` (n,2,3): 95 % range of the rates of ``compliant`` at the instants
    of the record, rad/s. ``lost``: runs of each model without an exit."""

    own: Flown
    rows: list[ComparedValue]
    band: np.ndarray
    count: int
    lost: dict[str, int]


def compared(own: Flown, folder: Path, cases: int, seed: int = 1) -> Flight:
    """``cases`` draws for each variant of the places in each model, beside the record."""
    folder.mkdir(parents=True, exist_ok=True)
    curve = folder / f"{own.launcher.name}.csv"
    rows = [f"{at:.6f},{value:.2f}\n" for at, value in record.thrust(own)]
    curve.write_text("time_s,force_N\n" + "".join(rows), encoding="utf-8")
    found: dict[str, list[dict[str, float]]] = {model: [] for model in MODELS}
    lost, rates = dict.fromkeys(MODELS, 0), []
    scenes = [
        launchers.scene(own.launcher, variant, curve, folder, number)
        for number, variant in enumerate(own.launcher.variants)
    ]
    with ThreadPoolExecutor(2) as pool:
        walls = list(pool.map(lambda scene: highfi.condense(scene, ELEMENT), scenes))
    for number, variant in enumerate(own.launcher.variants):
        scene, compliance = scenes[number], walls[number]
        draws = launchers.draws(cases, seed + number)
        say(f"{own.launcher.name}, variant {number + 1} of {len(own.launcher.variants)}")

        def solved(asked: tuple[str, dict[str, float]], scene=scene, compliance=compliance):
            model, draw = asked
            side = {"contact.clearance": NO_PLAY, "initial.position.z": 0.0}
            change = launchers.changes(own.launcher, draw) | (side if model == "no play" else {})
            if model == SPRINGS:
                return lowfi.run(scene.replace(change), SPRINGS)
            numerics = lowfi.Numerics.of_many(modes=MODES)
            return lowfi.run(
                scene.replace(change), COMPLIANT, compliance=compliance, numerics=numerics
            )

        for model in MODELS[:3]:
            with ThreadPoolExecutor(2) as pool:
                runs = pool.map(solved, [(model, draw) for draw in draws])
                for place, (run, draw) in enumerate(zip(runs, draws)):
                    if run.status != "exited" or run.outcome.exit_rate is None:
                        lost[model] += 1
                        continue
                    values, clean = predicted(own, run, draw, 1000 * number + place)
                    found[model].append(values)
                    if model == COMPLIANT:
                        rates.append(clean)
        found["pin"] += [
            pinned(own, scenes[number], variant, draw, 1000 * number + place)
            for place, draw in enumerate(draws)
        ]
    band = np.quantile(np.array(rates), [0.025, 0.975], axis=0)
    return Flight(own, table(measured(own), found), np.moveaxis(band, 0, 1), len(rates), lost)
