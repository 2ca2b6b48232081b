"""Reduced signals of drop tests as netCDF: a group for each test, all samples, in payload body
axes.

Rates and specific forces are stored twice: filtered by the channel frequency class of the log, as in the
figures, and calibrated without a filter, as used for the change of rate. ``doubtful`` is 1 for a sample
that is missing, frozen or clipped.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tipoff.files import write_netcdf
from tipoff.studies.measured.analysis import Drop
from tipoff.studies.measured.channel_class import filtered
from tipoff.studies.measured.events import WINDOWS

if TYPE_CHECKING:
    import xarray

_AXES = ("time", "axis")


def dataset(drop: Drop) -> "xarray.Dataset":
    """Signals (n,3) of one test over the time (n,) of its log, its windows (3,2) and its changes of
    rate (3,), with units as attributes; forces and temperature only where the log has them."""
    import xarray

    samples, sheet, found = drop.samples, drop.sheet, drop.reduced
    variables = {
        "rate": (_AXES, drop.filtered, {"units": "rad/s"}),
        "rate_unfiltered": (_AXES, samples.rate, {"units": "rad/s"}),
        "doubtful": ("time", drop.doubtful.astype(np.int8)),
        "windows": (
            ("window", "end"),
            [getattr(drop.spans, name) for name in WINDOWS],
            {"units": "s"},
        ),
        "change": ("axis", found.change, {"units": "rad/s"}),
        "standard_uncertainty": ("axis", found.combined, {"units": "rad/s"}),
    }
    if samples.force is not None:
        interval = float(samples.time[1] - samples.time[0])
        variables |= {
            "specific_force": (
                _AXES,
                filtered(samples.force, sheet.channel_class, interval),
                {"units": "m/s2"},
            ),
            "specific_force_unfiltered": (_AXES, samples.force, {"units": "m/s2"}),
        }
    if samples.temperature is not None:
        variables["temperature"] = ("time", samples.temperature, {"units": "K"})
    coordinates = {
        "time": ("time", samples.time, {"units": "s"}),
        "axis": list("xyz"),
        "window": list(WINDOWS),
        "end": ["begin", "end"],
    }
    return xarray.Dataset(
        variables,
        coordinates,
        attrs={
            "test": drop.name,
            "simulated": int(sheet.simulated),
            "description": sheet.description,
            "channel_class": sheet.channel_class or "none",
            "release_s": drop.events.release,
            "ignition_s": drop.events.ignition,
            "instant_s": drop.spans.instant,
            "notes": "\n".join(drop.notes),
        },
    )


def write(path: Path, drops: list[Drop]) -> None:
    """All tests in one file, each as the group of its name, atomically."""
    import xarray

    groups = {f"/{drop.name}": dataset(drop) for drop in drops}
    write_netcdf(path, xarray.DataTree.from_dict(groups))
