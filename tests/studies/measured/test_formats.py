"""Logs of other sensors and programs, written out as their own writers do, of one motion whose change of
rate is known. Least sampling rates for each purpose, with controls just below them."""

import numpy as np
import pytest

from tests.studies.measured.synthetic import EXIT, motion, sheet, spans
from tipoff.faults import SceneError
from tipoff.formats.instrument_table import PAGE
from tipoff.studies.measured import analysis
from tipoff.studies.measured.log import Calibrated
from tipoff.studies.measured.reduction import reduced

BEFORE, AFTER = np.array([0.002, -0.001, 0.003]), np.array([0.15, -0.05, -0.10])  # rad/s
NOISE, SHAKEN = 1e-4, 0.03  # rad/s, m/s2
G = 9.80665
START = 1403636579758555392  # ns, of the clock in EuRoC's first log
SHEET = f"""
file = "log.csv"
axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
{{top}}
[columns]
{{columns}}
[units]
{{units}}
[gyro]
range = "2000 deg/s"
resolution = "0.001 deg/s"
[gyro.uncertainty]
bias_instability = "0.003 deg/s"
scale = 0.0005
misalignment = "0.03 deg"
g_sensitivity = "0.0002 deg/s/(m/s**2)"
[accelerometer]
range = "400 m/s**2"
[windows]
exit = "{1e3 * EXIT:g} ms"
"""


def samples(rate):
    """time (n,) s, rate (n,3) rad/s with noise and specific force (n,3) m/s2 at ``rate`` Hz."""
    time, turning, force = motion(BEFORE, AFTER)
    at = np.arange(int(rate * time[-1]) + 1) / rate
    noise = np.random.default_rng(4).standard_normal((2, at.size, 3))
    moved, pushed = (
        np.column_stack([np.interp(at, time, column) for column in part.T])
        for part in (turning, force)
    )
    return at, moved + NOISE * noise[0], pushed + SHAKEN * noise[1]


def euroc(rate=200):
    lines = [
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]"
    ]
    for t, w, a in zip(*samples(rate)):
        row = ",".join(f"{value:.9f}" for value in (*w, *a))
        lines.append(f"{START + round(1e9 * t):d},{row}")
    return "\n".join(lines) + "\n"


def blackbox(rate=1000):
    """Of the viewer: settings above the header; gyros in deg/s, 2048 counts for g."""
    lines = [
        '"Product","Blackbox flight data recorder by Nicholas Sherlock"',
        '"rollPID","52,105,0,100,0"',
        '"looptime","125"',
        '"loopIteration","time","gyroADC[0]","gyroADC[1]","gyroADC[2]","accSmooth[0]",'
        '"accSmooth[1]","accSmooth[2]","motor[0]"',
    ]
    for number, (t, w, a) in enumerate(zip(*samples(rate))):
        turned = ",".join(f"{value:.4f}" for value in np.degrees(w))
        pushed = ",".join(f"{value:.0f}" for value in a / G * 2048.0)
        lines.append(f"{number},{37100000 + round(1e6 * t):d},{turned},{pushed},158")
    return "\n".join(lines) + "\n"


def px4(rate=250):
    lines = [
        "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,"
        "accelerometer_timestamp_relative,accelerometer_m_s2[0],accelerometer_m_s2[1],"
        "accelerometer_m_s2[2],accelerometer_integral_dt"
    ]
    for t, w, a in zip(*samples(rate)):
        turned, pushed = (",".join(f"{value:.8f}" for value in part) for part in (w, a))
        lines.append(f"{112500000 + round(1e6 * t):d},{turned},4000,0,{pushed},4000")
    return "\n".join(lines) + "\n"


def phyphox(rate=400):
    lines = [
        '"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)",'
        '"Acceleration x (m/s^2)","Acceleration y (m/s^2)","Acceleration z (m/s^2)"'
    ]
    for t, w, a in zip(*samples(rate)):
        lines.append(",".join(f"{value:.9E}" for value in (t, *w, *a)))
    return "\n".join(lines) + "\n"


def german(rate=400):
    """The same app with semicolons and decimal commas."""
    head, *rows = phyphox(rate).splitlines()
    rows = [row.replace(",", ";").replace(".", ",") for row in rows]
    return "\n".join([head.replace(",", ";"), *rows]) + "\n"


PHONE = (
    'rate = ["Gyroscope x", "Gyroscope y", "Gyroscope z"]\n'
    'acceleration = ["Acceleration x", "Acceleration y (m/s^2)", "Acceleration z"]'
)
# text, columns, units
LOGS = {
    "EuRoC": (
        euroc,
        'rate = ["w_RS_S_x", "w_RS_S_y", "w_RS_S_z"]\n'
        'acceleration = ["a_RS_S_x [m s^-2]", "a_RS_S_y", "a_RS_S_z"]\n'
        'time = "#timestamp [ns]"',
        "",
    ),
    "Betaflight": (
        blackbox,
        'time = "time"\nrate = ["gyroADC[0]", "gyroADC[1]", "gyroADC[2]"]\n'
        'acceleration = ["accSmooth[0]", "accSmooth[1]", "accSmooth[2]"]',
        'time = "us"\nrate = "deg/s"\nacceleration = "0.00478840332 m/s**2"',
    ),
    "PX4": (
        px4,
        'time = "timestamp"\nrate = ["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"]\n'
        'acceleration = ["accelerometer_m_s2[0]", "accelerometer_m_s2[1]", '
        '"accelerometer_m_s2[2]"]',
        'time = "us"\nrate = "rad/s"\nacceleration = "m/s**2"',
    ),
    "phyphox": (phyphox, PHONE, ""),
    "decimal commas": (german, PHONE, 'rate = "rad/s"'),
}


def written(folder, name, text=None, top="", units=None, columns=None):
    """Sheet and log of a format; what is given replaces its parts."""
    make, named, stated = LOGS[name]
    (folder / "log.csv").write_text(make() if text is None else text)
    text = SHEET.format(top=top, columns=columns or named, units=stated if units is None else units)
    (folder / "test.toml").write_text(text.replace("[units]\n\n", ""))
    return folder / "test.toml"


def refused(path):
    with pytest.raises(SceneError) as caught:
        analysis.analyse(path)
    return str(caught.value)


@pytest.mark.parametrize("name", LOGS)
def test_the_change_of_rate_is_found_in_each_format(tmp_path, name):
    """Within the stated uncertainty, which the noise and the bias instability bound."""
    found = analysis.analyse(written(tmp_path, name))
    error = np.abs(found.reduced.change - (AFTER - BEFORE))
    assert (error <= 1.5 * found.reduced.factor * found.reduced.combined).all()
    assert (found.reduced.combined < 5e-4).all()
    interval = found.samples.time[1] - found.samples.time[0]
    assert found.events.ignition - found.samples.time[0] == pytest.approx(
        1.5 + interval, abs=1.5 * interval
    )
    assert any("nothing is filtered" in note for note in found.notes)


def test_times_of_a_clock_count_from_the_first_sample(tmp_path):
    """To a millionth of a second. Control: microseconds since the start of a logger stay."""
    found = analysis.analyse(written(tmp_path, "EuRoC"))
    assert found.samples.time[0] == pytest.approx(0.0, abs=1e-6)
    assert found.samples.time[-1] == pytest.approx(samples(200)[0][-1], abs=1e-6)
    assert any("times count from the first sample, 1403636579.758555 s" in n for n in found.notes)
    assert analysis.analyse(written(tmp_path, "PX4")).samples.time[0] == pytest.approx(112.5)


def test_a_time_in_milliseconds_is_found_by_its_name(tmp_path):
    text = euroc().replace("#timestamp [ns]", "Time [ms]")
    text = "\n".join(
        line if "[" in line else f"{5 * k},{line.partition(',')[2]}"
        for k, line in enumerate(text.splitlines(), start=-1)
    )
    columns = LOGS["EuRoC"][1].replace('time = "#timestamp [ns]"', "")
    found = analysis.analyse(written(tmp_path, "EuRoC", text, columns=columns))
    assert found.samples.time[1] - found.samples.time[0] == pytest.approx(5e-3)


def test_a_filter_of_a_class_needs_its_rate(tmp_path):
    """The same log at 600 Hz is filtered. Control: 590 Hz is refused, and read without a class."""
    top = "channel_class = 60\n"
    found = analysis.analyse(written(tmp_path, "phyphox", phyphox(600), top))
    assert not any("nothing is filtered" in note for note in found.notes)
    assert np.abs(found.filtered - found.samples.rate).max() > 0.0
    said = refused(written(tmp_path, "phyphox", phyphox(590), top))
    assert "given 590 Hz, expected at least 600 Hz for CFC 60" in said and PAGE in said
    bare = analysis.analyse(written(tmp_path, "phyphox", phyphox(590)))
    assert np.abs(bare.filtered - bare.samples.rate).max() == 0.0
    np.testing.assert_allclose(bare.reduced.change, found.reduced.change, atol=2e-4)


@pytest.mark.parametrize("rate, words", [(130, ""), (120, "5 samples up to windows.exit")])
def test_an_ignition_needs_five_samples_up_to_the_exit(tmp_path, rate, words):
    """125 Hz for 40 ms."""
    path = written(tmp_path, "phyphox", phyphox(rate))
    if words:
        assert f"acceleration: given {rate} Hz, expected at least 125 Hz" in refused(path)
    else:
        found = analysis.analyse(path)
        error = np.abs(found.reduced.change - (AFTER - BEFORE))
        assert (error <= 1.5 * found.reduced.factor * found.reduced.combined).all()


def test_with_events_in_the_sheet_only_the_windows_need_a_rate(tmp_path):
    """100 Hz for ten samples in 100 ms. Control: 80 Hz."""
    events = '[events]\nrelease = "1.15 s"\nignition = "1.5 s"\n'

    def path(rate):
        found = written(tmp_path, "phyphox", phyphox(rate))
        found.write_text(found.read_text() + events)
        return found

    assert analysis.analyse(path(100)).reduced.change == pytest.approx(AFTER - BEFORE, abs=1e-3)
    said = refused(path(80))
    assert "time: given 80 Hz, expected at least 100 Hz for 10 samples in windows.settled" in said
    assert "acceleration" not in said


def thinned(text, every):
    """Accelerations in one of ``every`` samples, as of a slower sensor."""
    head, *rows = text.splitlines()
    cells = [row.split(",") for row in rows]
    rows = [row if k % every == 0 else [*row[:4], "", "", ""] for k, row in enumerate(cells)]
    return "\n".join([head, *map(",".join, rows)]) + "\n"


def test_accelerations_may_be_slower_than_rates(tmp_path):
    """200 Hz beside 1000 Hz. Control: 100 Hz is too slow for the ignition."""
    path = written(tmp_path, "phyphox", thinned(phyphox(1000), 5), "channel_class = 60\n")
    found = analysis.analyse(path)
    assert any("acceleration: given in one of 5 samples" in note for note in found.notes)
    assert found.reduced.change == pytest.approx(AFTER - BEFORE, abs=1e-3)
    assert "acceleration: given 100 Hz, expected at least 125 Hz" in refused(
        written(tmp_path, "phyphox", thinned(phyphox(1000), 10))
    )


@pytest.mark.parametrize(
    "name, change, words",
    [
        ("PX4", {"units": 'time = "us"\nacceleration = "m/s**2"'}, "units.rate: given no unit"),
        ("PX4", {"units": 'time = "us"\nrate = "m"'}, "units.rate"),
        ("EuRoC", {"units": 'time = "us"'}, "the unit 'ns' of timestamp [ns] in the header"),
        (
            "EuRoC",
            {"columns": LOGS["EuRoC"][1].replace("w_RS_S_x", "w")},
            "which has timestamp [ns], w_",
        ),
        (
            "PX4",
            {"columns": LOGS["PX4"][1].replace('time = "timestamp"', "")},
            "timestamp or accelerometer_timestamp_relative, expected the name of the time",
        ),
        ("phyphox", {"text": phyphox().replace("Time (s)", "n")}, "no name of a time"),
        ("phyphox", {"text": phyphox().replace("(rad/s)", "(rpm/V)")}, "'rpm/V'"),
        ("phyphox", {"text": "\n".join(phyphox().splitlines()[1:])}, "which has nothing"),
    ],
)
def test_logs_that_are_not_clear_are_refused(tmp_path, name, change, words):
    said = refused(written(tmp_path, name, **change))
    assert words in said and (PAGE in said or "units.rate" in said)


@pytest.mark.parametrize("rate", [100, 200])
def test_stated_intervals_cover_at_the_least_rate(rate):
    """95 % of 3 x 250 changes within U, up to what they can tell (99.9 %, binomial), for ten and for
    twenty samples after the exit. Control: half of U holds 67 %."""
    ask, (time, turning, _), ratios = sheet(channel_class=None), motion(BEFORE, AFTER), []
    for seed in range(250):
        rng = np.random.default_rng([rate, seed])
        at = (np.arange(int(rate * time[-1])) + rng.uniform()) / rate
        exact = np.column_stack([np.interp(at, time, column) for column in turning.T])
        noisy = exact + 1e-3 * rng.standard_normal(exact.shape)
        found = reduced(ask, Calibrated(at, noisy, None, None), spans(), "test")
        ratios.append(np.abs(found.change - (AFTER - BEFORE)) / (found.factor * found.combined))
    spread = 3.3 * np.sqrt(0.95 * 0.05 / 750)
    assert np.mean(np.array(ratios) <= 1.0) == pytest.approx(0.95, abs=spread)
    assert np.mean(np.array(ratios) <= 0.5) < 0.75


def test_gaps_and_clipping_of_a_slow_log_are_found(tmp_path):
    """Two missing lines of a log at 200 Hz are bridged, three in a window are refused; a rate at the
    range is refused there too."""
    head, *rows = euroc().splitlines()
    place = next(k for k, row in enumerate(rows) if int(row.split(",")[0]) > START + 1_560_000_000)

    def log(first, count, row=None):
        middle = [] if row is None else [row(each) for each in rows[first : first + count]]
        return "\n".join([head, *rows[:first], *middle, *rows[first + count :]]) + "\n"

    found = analysis.analyse(written(tmp_path, "EuRoC", log(place, 2)))
    assert any("rate: 1 gap of one or two samples bridged" in note for note in found.notes)
    assert "settled window: given 3 of" in refused(written(tmp_path, "EuRoC", log(place, 3)))

    def clipped(row):
        cells = row.split(",")
        return ",".join([cells[0], "34.906585040", *cells[2:]])

    said = refused(written(tmp_path, "EuRoC", log(place, 4, clipped)))
    assert "settled window: given 4 of" in said
