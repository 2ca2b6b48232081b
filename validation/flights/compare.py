"""Quantities of a launch, from a record and from runs in the same way, and the place of the measured among
the predicted ones.

A run is sampled at the instants of the record, turned by the unknown angle between rail and sensor, and gets
the noise of the record. So every quantity has the noise of the measurement on both sides.
"""

import itertools
import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff import highfi, lowfi
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.results.trajectory import Trajectory
from tipoff.workspace.progress import say
from validation.flights import launchers, record
from validation.flights.launchers import GRAVITY, HEDY, PSAS, Variant
from validation.flights.record import Record

ELEMENT = 20e-3  # m
MODES = 8  # as the studies of rocket_rail
NO_PLAY = 1e-6  # m on each side
MODELS = ("compliant", "no play", "springs", "pin")
BANDS = {PSAS.name: (5.0, 25.0, 60.0, 150.0, 400.0), HEDY.name: (3.0, 8.0, 16.0, 30.0, 50.0)}  # Hz
# deg/s between samples in turn: above six times the scatter of differences after the exit
JUMP = {PSAS.name: 15.0, HEDY.name: 15.0}
_SETTLED = 0.02  # s after the start, from which the rattling is taken


@dataclass(frozen=True)
class Row:
    """One comparison: the ``measured`` value and its ``uncertainty``, the predicted range (2.5, 50, 97.5 %) of
    each model, the share of values of ``compliant`` below the measured one, and whether the measured one is
    inside the 95 % range of each model."""

    quantity: str
    unit: str
    measured: float
    uncertainty: float | None
    ranges: dict[str, list[float]]
    rank: float
    inside: dict[str, bool]


def quantities(own: Record, rate: np.ndarray) -> dict[str, float]:
    """Rattling in rates (n,3) rad/s at the instants of the record: root mean squares over the way and in bands of
    frequency, deg/s, and jumps."""
    degrees, found = np.degrees(rate), {}
    kinds = {"roll": degrees[:, :1], "lateral": degrees[:, 1:]}
    ends = np.linspace(0.0, float(np.interp(own.exit[0], own.time, own.way)), 4)
    on = (own.time >= _SETTLED) & (own.time <= own.exit[0])
    for kind, values in kinds.items():
        for low, high in itertools.pairwise(ends):
            part = on & (own.way >= low) & (own.way <= high)
            found[f"rms of {kind} rate, {low:.1f} to {high:.1f} m, deg/s"] = _rms(values[part])
        grid = np.arange(_SETTLED, own.exit[0], float(np.median(np.diff(own.time))))
        even = np.column_stack([np.interp(grid, own.time, one) for one in values.T])
        power = np.abs(np.fft.rfft(even - even.mean(axis=0), axis=0)) ** 2
        frequency = np.fft.rfftfreq(grid.size, grid[1] - grid[0])
        for low, high in zip(BANDS[own.launcher.name][:-1], BANDS[own.launcher.name][1:]):
            band = (frequency >= low) & (frequency < high)
            value = math.sqrt(2.0 * float(power[band].sum())) / grid.size
            found[f"rms of {kind} rate, {low:g} to {high:g} Hz, deg/s"] = value
    jumps = np.abs(np.diff(degrees[on], axis=0)).max(axis=1) > JUMP[own.launcher.name]
    instants = own.time[on][1:][jumps]
    found["impacts: jumps of a rate, number"] = float(jumps.sum())
    found["impacts: first, s"] = float(instants[0]) if instants.size else own.exit[0]
    found["impacts: last, s"] = float(instants[-1]) if instants.size else own.exit[0]
    return found


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).sum(axis=1).mean()))


def measured(own: Record) -> dict[str, tuple[float, float | None]]:
    """Each quantity of the record and its uncertainty, None where the noise is in the predictions."""
    rate, spread = own.exit_rate()
    bias = own.pad_noise / math.sqrt(_independent(own))
    spread = np.degrees(np.hypot(spread, bias))
    rate = np.degrees(rate)
    speed, change = own.at_exit(own.speed)
    scale = record.SCALE[own.launcher.name]
    found: dict[str, tuple[float, float | None]] = {
        "time at the end of the rail, s": (own.left, 0.5 * (own.exit[1] - own.exit[0])),
        "speed at the end of the rail, m/s": (speed, math.hypot(change, scale * speed)),
    }
    for axis, name in enumerate("xyz"):
        found[f"rate {name} at the exit, deg/s"] = (float(rate[axis]), float(spread[axis]))
    across = math.hypot(rate[1], rate[2])
    found["lateral rate at the exit, deg/s"] = (across, float(np.hypot(*spread[1:]) / math.sqrt(2)))
    for name, value in quantities(own, own.rate).items():
        found[name] = (value, None)
    return found


def _independent(own: Record) -> float:
    """Independent samples on the pad, not above one each 50 ms: shaking has periods of some tens of ms."""
    first, last = record.PAD[own.launcher.name]
    return max(2.0, (last - first) / 0.05)


def predicted(
    own: Record, run: Trajectory, draw: dict[str, float], seed: int
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
    own: Record, clean: np.ndarray, left: tuple[float, float], at_exit: np.ndarray, seed: int
) -> tuple[dict[str, float], np.ndarray]:
    generator = np.random.default_rng(seed)
    stated = measured(own)
    values = [*left, *np.degrees(at_exit)]
    found = {
        name: value + (stated[name][1] or 0.0) * generator.standard_normal()
        for name, value in zip(stated, values)
    }
    found["lateral rate at the exit, deg/s"] = math.hypot(
        *(found[f"rate {name} at the exit, deg/s"] for name in "yz")
    )
    found.update(quantities(own, clean + own.shaken(generator)))
    return found, clean


def pinned(own: Record, variant: Variant, draw: dict[str, float], seed: int) -> dict[str, float]:
    """A rigid rocket without play that turns about its rear guide after the front one has left. The thrust
    and gravity across the rail turn it; it does not roll."""
    launcher = own.launcher
    travel = launcher.rail - variant.foot
    leaves = [
        float(np.interp(way, own.way, own.time))
        for way in (travel - variant.front + variant.rear, travel)
    ]
    mass, back = launcher.mass * draw["mass"], -variant.rear
    force = float(np.interp(own.left, *record.thrust(own).T))
    moment = np.zeros(2)  # about y and z
    for size, angle, sign in (
        (launcher.arm * math.radians(draw["misalignment"]), "misalignment_angle", 1.0),
        (draw["thrust_offset"], "thrust_offset_angle", 1.0),
        (draw["mass_offset"], "mass_offset_angle", -1.0),
    ):
        phi = math.radians(draw[angle])
        moment += sign * force * size * np.array([math.sin(phi), -math.cos(phi)])
    moment[0] += mass * GRAVITY * math.cos(launcher.elevation) * back
    inertia = launcher.transverse + mass * back**2
    rate = np.array([0.0, *(moment / inertia * (leaves[1] - leaves[0]))])
    clean = np.zeros((own.time.size, 3))
    free = (own.time > leaves[0])[:, None]
    share = np.clip((own.time - leaves[0]) / (leaves[1] - leaves[0]), 0.0, 1.0)[:, None]
    turn = _turn(draw["orientation"])
    clean = np.where(free, share * (turn @ rate), clean)
    speed = float(np.interp(leaves[1], own.time, own.speed))
    return _with_noise(own, clean, (leaves[1], speed), turn @ rate, seed)[0]


@dataclass
class Flight:
    """The comparison of a launch. ``band`` (n,2,3): 95 % range of the rates of ``compliant`` at the instants
    of the record, rad/s. ``lost``: runs of each model without an exit."""

    own: Record
    rows: list[Row]
    band: np.ndarray
    count: int
    lost: dict[str, int]


def compared(own: Record, folder: Path, cases: int, seed: int = 1) -> Flight:
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
            pinned(own, variant, draw, 1000 * number + place) for place, draw in enumerate(draws)
        ]
    band = np.quantile(np.array(rates), [0.025, 0.975], axis=0)
    return Flight(own, table(own, found), np.moveaxis(band, 0, 1), len(rates), lost)


def table(own: Record, found: dict[str, list[dict[str, float]]]) -> list[Row]:
    """Every comparison."""
    rows = []
    for name, (value, uncertainty) in measured(own).items():
        values = {model: [one[name] for one in draws] for model, draws in found.items() if draws}
        ranges = {
            model: np.quantile(one, [0.025, 0.5, 0.975]).tolist() for model, one in values.items()
        }
        inside = {model: ends[0] <= value <= ends[2] for model, ends in ranges.items()}
        quantity, _, unit = name.rpartition(", ")
        rank = _rank(values[COMPLIANT], value)
        rows.append(Row(quantity, unit, value, uncertainty, ranges, rank, inside))
    return rows


def _rank(values: Sequence[float], value: float) -> float:
    """The share of ``values`` below ``value``; equal ones count half."""
    every = np.array(values)
    return float(((every < value).sum() + 0.5 * (every == value).sum()) / every.size)
