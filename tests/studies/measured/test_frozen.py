"""A frozen channel repeats a value more often than its noise allows. Controls: sensors that are
coarse, quiet, slow or smooth repeat their values too."""

import numpy as np
import pytest

from tests.studies.measured import synthetic
from tipoff.faults import Fault, SceneError
from tipoff.studies.measured import analysis, log
from tipoff.studies.measured.frozen import frozen
from tipoff.studies.measured.sheet import SAMPLES

COUNT = 1850


def unit(noise: float, step: float, seed: int = 0, every: int = 1) -> np.ndarray:
    """Rates (n,3) deg/s of a payload that swings, falls and is ejected at sample 1550; a new value
    at one sample in ``every``."""
    rng, place = np.random.default_rng(seed), np.arange(COUNT)
    turned = 0.5 - 0.5 * np.cos(np.pi * np.clip((place - 1550) / 45.0, 0.0, 1.0))
    swing = np.where(place < 1150, 0.3 * np.sin(4.4e-3 * place), 0.0)
    rate = turned[:, None] * [2.0, -7.0, 9.2] + swing[:, None] * [0.2, 1.0, 0.1]
    rate += rng.uniform(-0.5, 0.5, 3) + noise * rng.standard_normal(rate.shape)
    rate = rate[place // every * every]
    return step * np.round(rate / step)


STRETCHES = {"start": (0, 1850), "middle": (1300, 1400), "exit": (1550, 1850), "end": (1780, 1850)}


@pytest.mark.parametrize("place", STRETCHES)
@pytest.mark.parametrize(
    "noise, step", [(0.12, 0.01), (0.02, 0.01), (0.2, 0.12), (0.5, 0.12)], ids=str
)
def test_a_frozen_axis_is_found_with_its_place(noise, step, place):
    begin, end = STRETCHES[place]
    values = unit(noise, step)
    assert frozen(values, step) == []
    values[begin:end, 2] = values[begin, 2]
    (run,) = frozen(values, step)
    assert run.axis == 2 and begin - 5 <= run.begin <= begin and end <= run.end <= end + 5
    assert run.allowed < end - begin


def test_all_axes_that_stop_together():
    """A logger that holds its last row. Control: the noise of the other axes says nothing then."""
    values = unit(0.12, 0.01)
    values[1550:] = values[1550]
    assert [run.axis for run in frozen(values, 0.01)] == [0, 1, 2]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "noise, step, every",
    [
        (0.1, 1.0, 1),  # coarse, at rest
        (0.0, 0.01, 1),  # without noise
        (0.002, 0.01, 1),  # quiet
        (0.01, 0.12, 1),  # of 12 bits
        (0.06, 0.12, 1),
        (0.3, 0.01, 10),  # each value ten times
    ],
    ids=str,
)
def test_a_working_sensor_repeats_its_values_too(noise, step, every, seed):
    values = unit(noise, step, seed, every)
    assert (np.diff(values, axis=0) == 0.0).any()
    assert frozen(values, step) == []


def test_a_step_that_is_coarser_than_stated():
    """Control: with the stated step the same values would seem noisy."""
    values = unit(0.1, 1.0)
    assert frozen(values, 0.01) == []


def test_channels_that_never_change_say_nothing():
    assert frozen(np.full((500, 3), 0.3)) == []


def test_vibration_that_ends_leaves_a_quiet_sensor():
    values = unit(0.01, 0.12)
    values[:1150] += 0.12 * np.random.default_rng(3).integers(-9, 10, (1150, 3))
    assert frozen(values, 0.12) == []


def test_smooth_noise_is_not_frozen():
    rng = np.random.default_rng(5)
    smooth = np.convolve(rng.standard_normal(COUNT + 19), np.ones(20) / 20.0, "valid")
    values = unit(0.0, 0.1) + 0.1 * np.round(4.0 * smooth[:, None] / 0.1)
    assert frozen(values, 0.1) == []


def test_noise_decides_how_many_equal_samples_are_chance():
    """The bound n p^(L-1) of the docstring against independent draws: with sigma = 2 q the longest
    run of a million samples stays below what is allowed for 1e-9."""
    rng = np.random.default_rng(1)
    values = np.round(2.0 * rng.standard_normal((400_000, 3)))
    assert frozen(values, 1.0) == []
    values[1000:1100, 0] = 3.0
    (run,) = frozen(values, 1.0)
    edges = np.flatnonzero(np.diff(values[:, 1]))
    assert np.diff(edges).max() < run.allowed < 100


@pytest.mark.parametrize("begin, is_refused", [(1.545, True), (1.72, False)])
def test_only_a_window_needs_the_channel(begin, is_refused):
    """A sensor that stops later, as in the net, is a note."""
    rng = np.random.default_rng(2)
    sensor = synthetic.QUIET._replace(gyro=synthetic.QUIET.gyro._replace(density=1e-5))
    drop = synthetic.log(sensor, np.zeros(3), np.array([0.1, -0.2, 0.3]), rng)
    place = log.Frozen(begin, 1.749, Fault("log.csv", "z", "0.3 rad/s", "a value that changes"))
    drop = drop._replace(frozen=(place,))
    if is_refused:
        with pytest.raises(SceneError, match="log.csv: z"):
            analysis.drop_of(synthetic.sheet(), drop, "log.toml")
        return
    found = analysis.drop_of(synthetic.sheet(), drop, "log.toml")
    assert any("frozen" in note for note in found.notes)
    assert found.doubtful.sum() == (drop.time >= begin).sum()


def test_a_log_whose_gyro_stops_at_the_ignition_is_refused(tmp_path):
    """It gave a rate of 0.1 deg/s about z with an uncertainty of 0.1; the true rate is larger."""
    sheet = SAMPLES[0]
    header, *rows = (sheet.with_suffix(".csv")).read_text().splitlines()[1:]
    place = header.split(",").index("gz")
    cells = [row.split(",") for row in rows]
    stop = next(k for k, row in enumerate(cells) if float(row[0]) >= 1.55)
    for row in cells[stop:]:
        row[place] = cells[stop][place]
    text = "\n".join([header, *map(",".join, cells)]) + "\n"
    (tmp_path / sheet.with_suffix(".csv").name).write_text(text)
    (tmp_path / "stopped.toml").write_text(sheet.read_text())
    with pytest.raises(SceneError) as refused:
        analysis.analyse(tmp_path / "stopped.toml")
    (fault,) = refused.value.faults
    assert fault.key == "gz" and f"{len(rows) - stop} samples, 1.55 to" in fault.given
