"""Contents of the netCDF file of a run: its variables with their dimensions and units, and its
attributes."""

import json
from typing import Any

from tipoff.files import FORMAT, FORMAT_KEY, Labelled, labelled_netcdf
from tipoff.mechanics import ledger, outcome

VECTOR = ("x", "y", "z")
DIMENSIONS = {
    "position": ("time", "axis"),
    "velocity": ("time", "axis"),
    "quaternion": ("time", "component"),
    "rate": ("time", "axis"),
    "platform_position": ("time", "axis"),
    "platform_velocity": ("time", "axis"),
    "platform_quaternion": ("time", "component"),
    "platform_rate": ("time", "axis"),
    "pad_force": ("time", "face", "axis"),
    "energy": ("time", "entry"),
    "transverse_energy": ("time", "entry"),
    "wall_stress": ("time", "patch", "stress_component"),
    "guide_time": ("guide",),
    "guide_force": ("guide", "axis"),
    "guide_moment": ("guide", "axis"),
}
PLAIN = ("checks", "cost", "scene", "numerics", "versions", "stress")
# those that a run may lack
OPTIONAL = {"wall_stress", "guide_time", "guide_force", "guide_moment"}
STRESS = ("xx", "yy", "zz", "xy", "yz", "zx")
UNITS = {
    "position": "m",
    "velocity": "m/s",
    "quaternion": "1",
    "rate": "rad/s",
    "platform_position": "m",
    "platform_velocity": "m/s",
    "platform_quaternion": "1",
    "platform_rate": "rad/s",
    "pad_force": "N",
    "energy": "J",
    "transverse_energy": "J",
    "wall_stress": "Pa",
    "guide_time": "s",
    "guide_force": "N",
    "guide_moment": "N*m",
}


def content(run: Any) -> memoryview:
    """The netCDF file of a run, without its digest; the same data as of ``to_xarray``."""
    return labelled_netcdf(variables(run), attributes(run))


def variables(run: Any) -> dict[str, Labelled]:
    found: dict[str, Labelled] = {
        name: (dims, getattr(run, name), {"units": UNITS[name]})
        for name, dims in DIMENSIONS.items()
    }
    relative = outcome.relative_motion(run)
    for name, unit in (
        ("relative_position", "m"),
        ("relative_velocity", "m/s"),
        ("relative_rate", "rad/s"),
    ):
        found[name] = ("time", "axis"), relative[name], {"units": unit}
    texts = {"axis": VECTOR, "component": ("w", "x", "y", "z"), "entry": ledger.ENTRIES}
    # netCDF takes a dimension of length zero as unlimited
    for name in OPTIONAL:
        if not getattr(run, name).size:
            del found[name]
    if "wall_stress" in found:
        texts["stress_component"] = STRESS
    found["time"] = ("time",), run.time, {"units": "s"}
    return found | {name: ((name,), list(labels), {}) for name, labels in texts.items()}


def attributes(run: Any) -> dict[str, Any]:
    plain = {name: json.dumps(getattr(run, name), allow_nan=False) for name in PLAIN}
    return {
        **({} if run.error is None else {"error": run.error.written()}),
        FORMAT_KEY: FORMAT,
        "model": run.model,
        "status": run.status,
        "message": run.message,
        "outcome": json.dumps(run.outcome._asdict()),
        **plain,
    }
