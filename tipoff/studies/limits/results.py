"""The quantities of all cases within one set of tolerances, as a netCDF file with names and
units."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tipoff.cache import Cache, binary
from tipoff.files import netcdf
from tipoff.studies.populations import answers


def kept(scale: float, tolerances: Mapping[str, float]) -> Cache[np.ndarray]:
    """Cache of values (n,k) of ``answers.ALL``, with ``scale`` and the ``tolerances`` (SI) at that
    scale as attributes of each file."""
    return binary(lambda values: _content(values, scale, tolerances), _load)


def _content(
    values: np.ndarray, scale: float, tolerances: Mapping[str, float]
) -> bytes | memoryview:
    import xarray

    found = xarray.Dataset(
        {
            "value": (
                ("case", "quantity"),
                values,
                {"long_name": "quantity of a case after the exit, NaN where it did not settle"},
            )
        },
        {
            "case": np.arange(len(values)),
            "quantity": [item.name for item in answers.ALL],
            "units": ("quantity", [item.unit for item in answers.ALL]),
        },
        {"scale": scale, "tolerances_si": json.dumps(dict(tolerances))},
    )
    return netcdf(found)


def _load(path: Path) -> np.ndarray:
    import xarray

    with xarray.open_dataset(path, engine="h5netcdf") as found:
        return found["value"].transpose("case", "quantity").values
