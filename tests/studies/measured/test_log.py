"""Reading logs: what is repaired is said, what cannot be is refused with every fault, and nothing
passes silently."""

import re

import numpy as np
import pytest

from tipoff.faults import SceneError
from tipoff.studies.measured import analysis
from tipoff.studies.measured.log import read, runs
from tipoff.studies.measured.sheet import SAMPLES

SHEET, TABLE = (path.read_text() for path in (SAMPLES[0], SAMPLES[0].with_suffix(".csv")))
IN_REFERENCE, IN_SETTLED, IN_BURN = 1400, 1720, 1665  # samples


def written(folder, sheet=SHEET, rows=None):
    """Sheet and log in a folder; ``rows`` changes the list of samples, each a list of cells."""
    head, names, *samples = TABLE.splitlines()
    cells = [line.split(",") for line in samples]
    cells = rows(cells) if rows else cells
    (folder / "simulated0.csv").write_text("\n".join([head, names, *map(",".join, cells)]) + "\n")
    (folder / "test.toml").write_text(sheet)
    return folder / "test.toml"


def without(first, count):
    return lambda cells: cells[:first] + cells[first + count :]


def changed(first, count, column, text):
    def change(cells):
        for row in cells[first : first + count]:
            row[column] = text
        return cells

    return change


def refused(path):
    with pytest.raises(SceneError) as caught:
        analysis.analyse(path)
    return str(caught.value)


def test_runs_of_true():
    assert (
        runs(np.array([True, False, True, True])) == [(0, 1), (2, 4)]
        and runs(np.zeros(3, dtype=bool)) == []
    )


def test_units_are_converted_and_a_whole_log_leaves_no_note(tmp_path):
    sheet, log = read(written(tmp_path))
    assert np.degrees(log.rate[0]).tolist() == pytest.approx(
        [float(cell) for cell in TABLE.splitlines()[2].split(",")[1:4]]
    )
    assert log.temperature[0] == pytest.approx(273.15 + float(TABLE.splitlines()[2].split(",")[-1]))
    assert log.interval == pytest.approx(1e-3)
    assert sheet.gyro.reference_temperature == pytest.approx(298.15) and not log.doubtful.any()
    assert sheet.gyro.g_sensitivity[0][0] == pytest.approx(np.radians(0.004))
    in_other_units = SHEET.replace('time = "s"', 'time = "min"').replace("60\n", "60\n", 1)
    with pytest.raises(SceneError, match="Hz for CFC 60"):
        read(written(tmp_path, in_other_units))


@pytest.mark.parametrize("step", [0.25, 0.5, 1.0])
def test_rates_in_coarse_steps_are_settled(tmp_path, step):
    """The rate lies between two steps, and the noise is below half of one. Control: rates of such a
    scatter in a log with fine steps."""
    head, names, *samples = SAMPLES[1].with_suffix(".csv").read_text().splitlines()
    cells = [line.split(",") for line in samples]
    for row in cells:
        row[1:4] = [f"{step * round(float(cell) / step):.3f}" for cell in row[1:4]]
    (tmp_path / "simulated1.csv").write_text("\n".join([head, names, *map(",".join, cells)]) + "\n")
    sheet = SAMPLES[1].read_text()
    stated = re.sub(r'(\[gyro\][^[]*?resolution = )"[^"]*"', rf'\1"{step} deg/s"', sheet)
    (tmp_path / "test.toml").write_text(stated)
    assert stated != sheet
    analysis.analyse(tmp_path / "test.toml")
    if step > 0.25:  # twice the noise
        rng = np.random.default_rng(5)
        for row in cells:
            row[1:4] = [f"{float(cell) + 0.1 * step * rng.random():.6f}" for cell in row[1:4]]
        (tmp_path / "simulated1.csv").write_text("\n".join([head, names, *map(",".join, cells)]))
        (tmp_path / "test.toml").write_text(
            stated.replace(f'"{step} deg/s"', f'"{step / 8} deg/s"')
        )
        assert "settled window" in refused(tmp_path / "test.toml")


@pytest.mark.parametrize(
    "rows",
    [
        without(IN_REFERENCE, 2),
        changed(IN_REFERENCE, 2, 2, ""),
        changed(IN_SETTLED, 1, 3, "nan"),
        changed(IN_BURN, 2, 1, "inf"),
    ],
)
def test_gaps_of_one_or_two_samples_are_bridged_and_said(tmp_path, rows):
    """The rate changes by less than its noise does to two samples of a hundred."""
    whole, found = (
        analysis.analyse(SAMPLES[0]),
        analysis.analyse(written(tmp_path, rows=rows)),
    )
    assert any("bridged by a straight line" in note for note in found.notes) and not any(
        "bridged" in note for note in whole.notes
    )
    assert found.samples.time.size == whole.samples.time.size
    assert (
        np.abs(found.reduced.change - whole.reduced.change).max()
        < 0.5 * whole.reduced.combined.max()
    )


@pytest.mark.parametrize(
    "first, window", [(IN_REFERENCE, "reference"), (IN_SETTLED, "settled"), (700, "rest")]
)
def test_a_longer_gap_inside_a_window_is_refused(tmp_path, first, window):
    assert f"{window} window: given 8 of" in refused(written(tmp_path, rows=without(first, 8)))
    assert f"{window} window: given 3 of" in refused(
        written(tmp_path, rows=changed(first, 3, 2, ""))
    )
    assert f"{window} window: given 4 of" in refused(
        written(tmp_path, rows=changed(first, 4, 3, "-250.00"))
    )


@pytest.mark.parametrize(
    "rows, words",
    [
        (without(IN_BURN, 8), "8 samples missing from 1.665 s"),
        (changed(IN_BURN, 3, 2, "250.00"), "3 samples clipped at the range of 250 deg/s"),
    ],
)
def test_a_longer_gap_or_clipping_elsewhere_is_left_out_and_said(tmp_path, rows, words):
    found = analysis.analyse(written(tmp_path, rows=rows))
    assert any(words in note for note in found.notes)
    np.testing.assert_allclose(
        found.reduced.change, analysis.analyse(SAMPLES[0]).reduced.change, atol=1e-12
    )


def slowly(every, column):
    """A column that has a value in one of ``every`` samples."""

    def change(cells):
        for number, row in enumerate(cells):
            row[column] = row[column] if number % every == 0 else ""
        return cells

    return change


def test_a_temperature_that_is_sampled_slowly_is_interpolated_and_said(tmp_path):
    """Its ramp of 0.05 K/s is rounded to 0.1 K. Control: a rate that is sampled so is refused in
    every window."""
    whole, found = (
        analysis.analyse(SAMPLES[0]),
        analysis.analyse(written(tmp_path, rows=slowly(100, 7))),
    )
    assert np.abs(found.samples.temperature - whole.samples.temperature).max() < 0.11
    np.testing.assert_allclose(
        found.reduced.change, whole.reduced.change, atol=0.01 * whole.reduced.combined.min()
    )
    assert any(
        "temperature: given in 19 of 1850 samples" in note and "over 0.1 s at most" in note
        for note in found.notes
    )
    assert not any("temperature" in note for note in whole.notes)
    message = refused(written(tmp_path, rows=slowly(100, 2)))
    assert all(f"{window} window" in message for window in ("rest", "reference", "settled"))
    assert "temperature: given no number" in refused(
        written(tmp_path, rows=changed(0, 5000, 7, ""))
    )


def test_small_jitter_is_interpolated_and_said_and_large_is_refused(tmp_path):
    def jittered(share):
        shift = share * 1e-3 * np.random.default_rng(1).uniform(-1.0, 1.0, 5000)
        shift[0] = 0.0
        return lambda cells: [
            [f"{float(row[0]) + late:.6f}", *row[1:]] for row, late in zip(cells, shift)
        ]

    found = analysis.analyse(written(tmp_path, rows=jittered(0.2)))
    assert any("jitters by up to" in note and "even grid" in note for note in found.notes)
    whole = analysis.analyse(SAMPLES[0])
    assert np.abs(found.reduced.change - whole.reduced.change).max() < whole.reduced.combined.max()
    assert "off an even grid" in refused(written(tmp_path, rows=jittered(0.49)))


def test_what_is_wrong_with_a_table_is_listed(tmp_path):
    assert "increasing order" in refused(written(tmp_path, rows=changed(100, 1, 0, "0.050")))
    assert "without a time" in refused(written(tmp_path, rows=changed(100, 1, 0, "")))
    assert "at least 100" in refused(written(tmp_path, rows=lambda cells: cells[:50]))
    message = refused(
        written(
            tmp_path, rows=lambda cells: changed(100, 1, 2, "x")(changed(7, 1, 3, "1.0.0")(cells))
        )
    )
    assert "2 faults" in message and "line 10" in message and "line 103" in message
    assert "no such column" in refused(written(tmp_path, SHEET.replace('"gx"', '"wx"')))
    assert "no_such" in refused(written(tmp_path, SHEET.replace("simulated0.csv", "no_such.csv")))


@pytest.mark.parametrize(
    "old, new, words",
    [
        ("channel_class = 60", "channel_class = 180", "at least 1800 Hz for CFC 180"),
        ("channel_class = 60", "channel_class = 100", "60, 180, 600 or 1000"),
        ('rate = "deg/s"', 'rate = "m/s"', "units.rate"),
        ('rate = "deg/s"', 'rate = "Hz"', "units.rate"),
        ('acceleration = "m/s**2"', 'acceleration = "g_0"', "9.807 m/s2 within 5 %"),
        ("[[0, 1, 0], [-1, 0, 0], [0, 0, 1]]", "[[0, 1, 0], [1, 0, 0], [0, 0, 1]]", "right-handed"),
        (
            "[[0, 1, 0], [-1, 0, 0], [0, 0, 1]]",
            "[[0, 1, 0], [-1, 0.1, 0], [0, 0, 1]]",
            "perpendicular",
        ),
        (
            "[[0, 1, 0], [-1, 0, 0], [0, 0, 1]]",
            "[[0, -1, 0], [1, 0, 0], [0, 0, 1]]",
            "are the axes correct",
        ),
        ('range = "250 deg/s"', "", "gyro.range"),
        ("scale = 0.0005", "scale = -1", "gyro.uncertainty.scale"),
        ("[windows]", '[windows]\nrst = "1 s"', "windows.rst"),
        ('exit = "44.4 ms"', 'exit = "120 ms"', "settled window"),
        ('exit = "44.4 ms"', 'exit = "25 ms"', "deg/s of scatter"),
        ('rest = "1 s"', 'rest = "2 s"', "rest window"),
        ("[units]\n", '[units]\npressure = "Pa"\n', "units.pressure"),
        ('temperature = "degC"\n', "", "units.temperature: given no unit"),
    ],
)
def test_sheets_that_cannot_be_are_refused(tmp_path, old, new, words):
    assert old in SHEET
    assert words in refused(written(tmp_path, SHEET.replace(old, new, 1)))


def test_every_fault_of_a_sheet_is_listed(tmp_path):
    sheet = SHEET.replace('rate = "deg/s"', 'rate = "m"').replace(
        'settled = "100 ms"', 'settled = "-1 ms"'
    )
    message = refused(written(tmp_path, sheet))
    assert "2 faults" in message and "units.rate" in message and "windows.settled" in message


def test_missing_release_and_missing_ignition_are_refused(tmp_path):
    assert "begins in free fall" in refused(written(tmp_path, rows=lambda cells: cells[1260:]))
    assert "no acceleration along +X" in refused(written(tmp_path, rows=lambda cells: cells[:1640]))
    assert "no free fall" in refused(written(tmp_path, rows=lambda cells: cells[:1200]))


def test_without_accelerations_the_sheet_must_say_when(tmp_path):
    without_columns = ("acceleration =", 'temperature = "d', 'temperature = "t')
    lines = [line for line in SHEET.splitlines() if not line.startswith(without_columns)]
    start = lines.index("[accelerometer]")
    bare = "\n".join(lines[:start] + lines[start + 4 :])
    assert "[events] that says when" in refused(written(tmp_path, bare))
    found = analysis.analyse(
        written(tmp_path, bare + '\n[events]\nrelease = "1.25 s"\nignition = "1.65 s"\n')
    )
    for words in (
        "release and ignition from the sheet",
        "g-sensitivity not compensated",
        "temperature not compensated",
        "in both windows",
    ):
        assert any(words in note for note in found.notes)
    whole = analysis.analyse(SAMPLES[0])
    assert np.abs(found.reduced.change - whole.reduced.change).max() < whole.reduced.combined.max()


def test_a_broken_settling_rule_is_said(tmp_path):
    found = analysis.analyse(
        written(tmp_path, SHEET.replace('rest_rate = "0.5 deg/s"', 'rest_rate = "0.1 deg/s"'))
    )
    assert any(
        "settling rule broken" in note and "0.1 deg/s allowed" in note for note in found.notes
    )
    assert not any("settling rule" in note for note in analysis.analyse(SAMPLES[0]).notes)


@pytest.mark.parametrize("time", ["1e9", "1e300", "100000"])
def test_one_bad_time_does_not_ask_for_a_grid_of_billions(tmp_path, time):
    said = refused(written(tmp_path, rows=_late(time)))
    assert "a gap from" in said and "10 times as many instants as samples" in said


def _late(time):
    def change(cells):
        cells[-1][0] = time
        return cells

    return change


def test_a_gyro_without_an_inverse_is_refused(tmp_path):
    sheet = re.sub(r"scale_error = .*", "scale_error = [-1, 0, 0]", SHEET, count=1)
    assert sheet != SHEET
    assert "gyro.scale_error.0" in refused(written(tmp_path, sheet))


def rounded(step):
    """Every rate rounded to a ``step`` (deg/s)."""

    def change(cells):
        for row in cells:
            row[1:4] = [f"{step * round(float(cell) / step):.6g}" for cell in row[1:4]]
        return cells

    return change


@pytest.mark.parametrize("step", [0.0625, 0.125, 0.25, 0.5])
@pytest.mark.parametrize("stated", ["0.01 deg/s", "0.001 deg/s", "1e-6 deg/s", "0 deg/s"])
def test_the_steps_of_the_samples_count_where_they_are_coarser_than_stated(tmp_path, step, stated):
    """A whole log without a clipped sample. Control: the sheet that states the step."""
    found = {}
    for name in (stated, f"{step} deg/s"):
        sheet = re.sub('resolution = ".*"', f'resolution = "{name}"', SHEET)
        path = written(tmp_path, sheet, rounded(step))
        read_sheet, log = read(path)
        assert np.degrees(read_sheet.gyro.resolution) == pytest.approx(step)
        assert not log.doubtful.any()
        assert any(f"steps of {step:.3g} deg/s" in note for note in log.notes) == (
            name == stated != "0 deg/s"
        )
        found[name] = analysis.analyse(path).reduced
    for name, part in found[f"{step} deg/s"].parts.items():
        np.testing.assert_allclose(found[stated].parts[name], part)


def test_samples_without_steps_leave_the_stated_resolution(tmp_path):
    """Control: the smallest difference of all samples is larger than this resolution."""
    rng = np.random.default_rng(3)

    def fine(cells):
        for row in cells:
            row[1:4] = [f"{float(cell) + 0.02 * rng.standard_normal():.9f}" for cell in row[1:4]]
        return cells

    sheet, log = read(written(tmp_path, SHEET.replace('"0.01 deg/s"', '"1e-7 deg/s"'), fine))
    assert np.degrees(sheet.gyro.resolution) == pytest.approx(1e-7)
    assert np.abs(np.diff(log.rate, axis=0)).min() > sheet.gyro.resolution
    assert not any("steps" in note for note in log.notes) and not log.doubtful.any()
