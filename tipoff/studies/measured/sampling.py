"""Least sampling rates of a log, for each channel and purpose.

| channel | purpose | least rate |
|---|---|---|
| rate | a filter of class c (SAE J211) | 10 c |
| rate | mean and straight line in the windows | 10 samples in the shortest window of the sheet |
| acceleration | release, 50 ms of free fall | 5 samples in it |
| acceleration | ignition, a push up to the exit | 5 samples from ignition to exit |
| rate, acceleration | line after the exit of a launch | 5 samples in ``launch.after`` |
| temperature | drift | none |

The change of rate is a difference of a mean and a line, and both use samples that are not filtered.
So only the filter needs the rate of its class. Ten samples about a line have eight degrees of
freedom, and their noise is known to 25 %: enough to tell a blow after the exit from noise. Five
samples tell a fall or a push from a knock, and miss at most a fifth of its impulse. With ``[events]``
in the sheet nothing is searched in accelerations.
"""

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.formats.logs.sensor_log import SECTION
from tipoff.studies.measured.channel_class import SAMPLES_PER_CLASS
from tipoff.studies.measured.sheet import LaunchSheet, Sheet

FALL = 0.05  # s of free fall; a knock is shorter
_IN_WINDOW, _IN_EVENT = 10, 5  # samples
_ROUNDING = 1e-6  # relative, of an interval


def least(sheet: Sheet | LaunchSheet) -> list[tuple[str, float, str]]:
    """Channel, least sampling rate (Hz) and purpose."""
    found = []
    if sheet.channel_class is not None:
        rate, name = SAMPLES_PER_CLASS * sheet.channel_class, f"CFC {sheet.channel_class}"
        found.append(
            ("time", rate, f"{name} (SAE J211); without channel_class nothing is filtered")
        )
    if isinstance(sheet, LaunchSheet):
        purpose, rate = f"{_IN_EVENT} samples in launch.after", _IN_EVENT / sheet.launch.after
        return [*found, ("time", rate, purpose), ("acceleration", rate, purpose)]
    windows = {name: getattr(sheet.windows, name) for name in ("rest", "settled")}
    shortest = min(windows, key=lambda name: windows[name])
    purpose = f"{_IN_WINDOW} samples in windows.{shortest}"
    found.append(("time", _IN_WINDOW / windows[shortest], purpose))
    if sheet.events is None:
        purpose = f"{_IN_EVENT} samples in {1e3 * FALL:g} ms of free fall, or [events]"
        found.append(("acceleration", _IN_EVENT / FALL, purpose))
        purpose = f"{_IN_EVENT} samples up to windows.exit, or [events]"
        found.append(("acceleration", _IN_EVENT / sheet.windows.exit, purpose))
    return found


def require(sheet: Sheet | LaunchSheet, interval: float, every: int, source: str) -> None:
    """Check the ``interval`` (s) of a log, of whose samples one in ``every`` has an acceleration.
    Raises SceneError."""
    intervals = {"time": interval, "acceleration": every * interval}
    faults = [
        Fault(
            source,
            channel,
            f"{1.0 / intervals[channel]:.4g} Hz",
            f"at least {rate:.4g} Hz for {purpose}; {SECTION}",
        )
        for channel, rate, purpose in least(sheet)
        if intervals[channel] * rate > 1.0 + _ROUNDING
    ]
    if faults:
        raise SceneError(faults)


def every(columns: np.ndarray, place: np.ndarray) -> int:
    """Of how many instants of the grid one has a value of ``columns`` (n,k), whose samples belong to
    the instants ``place`` (n,)."""
    known = place[np.isfinite(columns).all(axis=1)]
    return max(1, int(np.median(np.diff(known)))) if known.size > 1 else 1
