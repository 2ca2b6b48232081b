"""Makes the three logs that come with the package, all SIMULATED;
``python -m tests.studies.measured.shipped`` writes them again.

Each is a case of the surrogate on the reference scene with its own contact constants (not the
calibrated ones), offsets drawn from the catalogue's ``paper`` distributions with a seed that no
study uses, dropped in ``tower.py`` and measured by the unit of ``sensor.py``. The true errors of
that unit are those of the sheet plus a draw of their stated uncertainties.
"""

from pathlib import Path

import numpy as np

from tests.studies.measured import tower
from tests.studies.measured.sensor import Channel, Sensor, measured
from tests.studies.measured.tower import Motion, Tower
from tipoff import scenes
from tipoff.files import write_text
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import uncertainty
from tipoff.studies.measured.sheet import SAMPLES

COUNT = 3
_SEED, _INTERVAL = 20260, 1e-3
_LABEL = "SIMULATED, not measured: surrogate and sensor model"
# What the sheet states, in its units (degrees). The unit lies with its x axis along the payload's
# -Y.
_BIAS, _SCALE, _SKEW = (
    (0.35, -0.22, 0.14),
    (0.004, -0.003, 0.002),
    ((0.0, 0.08, -0.05), (0.04, 0.0, 0.06), (-0.07, 0.03, 0.0)),
)
_G, _DRIFT = (
    ((0.004, -0.001, 0.002), (0.001, 0.003, -0.002), (-0.002, 0.001, 0.005)),
    (0.010, -0.006, 0.004),
)
_AXES = ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
_NOISE, _INSTABILITY, _RESOLUTION, _RANGE = 0.004, 0.003, 0.01, 250.0
_U_SCALE, _U_SKEW, _U_G, _U_DRIFT, _U_BIAS = 5e-4, 0.03, 2e-4, 1e-3, 0.05
_FORCE_BIAS, _FORCE_SCALE = (0.05, -0.03, 0.04), (0.002, -0.001, 0.001)
_FORCE_NOISE, _FORCE_RESOLUTION, _FORCE_RANGE = 2e-3, 0.02, 400.0
_EXIT = 0.0444  # s; what a light barrier would have said, within 0.5 ms


def make(number: int) -> tuple[str, str, Motion]:
    """CSV and TOML of log ``number`` (0 to COUNT - 1), and the true motion."""
    scene = scenes.load("reference")
    rng = np.random.default_rng([_SEED, number])
    row = Drawn(uncertainty.load("paper", scene, cases=COUNT, seed=_SEED)).rows(number, number + 1)[
        0
    ]
    turns = np.radians(rng.uniform(-0.12, 0.12, 3))
    motion = tower.drop(scene.replace(row), Tower(rate=tuple(turns.tolist())), _INTERVAL)
    warm = 295.0 + 0.4 * number + 0.05 * motion.time
    rate, force = measured(_sensor(rng), motion.rate, motion.force, warm, _INTERVAL, rng)
    table = np.column_stack([motion.time, np.degrees(rate), force, warm - 273.15])
    head = f"# {_LABEL} ({number})\ntime,gx,gy,gz,ax,ay,az,temperature\n"
    form = "%.3f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.1f\n"
    lines = [form % tuple(values) for values in table.tolist()]
    return (head + "".join(lines)).replace("-0.00,", "0.00,"), _sheet(number), motion


def _sensor(rng: np.random.Generator) -> Sensor:
    """A unit whose errors are those of the sheet, as far as its calibration knows them."""

    def near(values, spread):
        values = np.array(values)
        return values + spread * rng.standard_normal(values.shape)

    skew = near(_SKEW, _U_SKEW)
    np.fill_diagonal(skew, 0.0)
    gyro = Channel(
        np.radians(near(_BIAS, _U_BIAS)),
        near(_SCALE, _U_SCALE),
        np.radians(_NOISE),
        np.radians(_RESOLUTION),
        np.radians(_RANGE),
    )
    force = Channel(
        np.array(_FORCE_BIAS), np.array(_FORCE_SCALE), _FORCE_NOISE, _FORCE_RESOLUTION, _FORCE_RANGE
    )
    return Sensor(
        gyro,
        force,
        np.radians(skew),
        np.radians(near(_G, _U_G)),
        np.radians(near(_DRIFT, _U_DRIFT)),
        298.15,
        np.radians(_INSTABILITY),
        np.array(_AXES),
    )


def _sheet(number: int) -> str:
    def with_unit(values, unit: str) -> str:
        if isinstance(values, tuple):
            return "[" + ", ".join(with_unit(value, unit) for value in values) + "]"
        return f'"{values:g} {unit}"' if unit else f"{values:g}"

    return f"""# {_LABEL} ({number})
description = "{_LABEL} ({number})"
simulated = true
scene = "reference"
file = "simulated{number}.csv"
channel_class = 60
axes = {with_unit(_AXES, "")}

[columns]
time = "time"
rate = ["gx", "gy", "gz"]
acceleration = ["ax", "ay", "az"]
temperature = "temperature"

[units]
time = "s"
rate = "deg/s"
acceleration = "m/s**2"
temperature = "degC"

[gyro]
range = "{_RANGE:g} deg/s"
resolution = "{_RESOLUTION:g} deg/s"
bias = {with_unit(_BIAS, "deg/s")}
scale_error = {with_unit(_SCALE, "")}
misalignment = {with_unit(_SKEW, "deg")}
g_sensitivity = {with_unit(_G, "deg/s/(m/s**2)")}
temperature = {with_unit(_DRIFT, "deg/s/K")}
reference_temperature = "25 degC"

[gyro.uncertainty]
bias_instability = "{_INSTABILITY:g} deg/s"
scale = {_U_SCALE:g}
misalignment = "{_U_SKEW:g} deg"
g_sensitivity = "{_U_G:g} deg/s/(m/s**2)"
temperature = "{_U_DRIFT:g} deg/s/K"

[accelerometer]
range = "{_FORCE_RANGE:g} m/s**2"
bias = {with_unit(_FORCE_BIAS, "m/s**2")}
scale_error = {with_unit(_FORCE_SCALE, "")}

[windows]
exit = "{1e3 * _EXIT:g} ms"
exit_uncertainty = "0.5 ms"
rest = "1 s"
rest_rate = "0.5 deg/s"
after_release = "60 ms"
settled = "100 ms"
"""


def write(folder: Path = SAMPLES[0].parent) -> None:
    """Write all of them into ``folder``."""
    for number in range(COUNT):
        table, sheet, _ = make(number)
        write_text(folder / f"simulated{number}.csv", table)
        write_text(folder / f"simulated{number}.toml", sheet)


if __name__ == "__main__":
    write()
