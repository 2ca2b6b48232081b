"""The quantities of all cases within one set of tolerances, as a netCDF file with names and
units."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tipoff.files import DamageError, require_whole, write_netcdf
from tipoff.studies.populations import answers
from tipoff.workspace.progress import say


def save(path: Path, values: np.ndarray, scale: float, tolerances: Mapping[str, float]) -> None:
    """Write ``values`` (n,k) of ``answers.ALL`` atomically, with ``scale`` and the ``tolerances``
    (SI) at that scale as attributes."""
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
    write_netcdf(path, found)


def load(path: Path) -> np.ndarray | None:
    """The values (n,k) that ``save`` wrote. None where there are none or they are of other
    quantities; None with a message where the file is damaged."""
    if not path.is_file():
        return None
    import xarray

    try:
        require_whole(path)
        with xarray.open_dataset(path, engine="h5netcdf") as found:
            same = found["quantity"].values.tolist() == [item.name for item in answers.ALL]
            return found["value"].transpose("case", "quantity").values if same else None
    except DamageError as fault:
        say(f"  {path} {fault.reason}: its cases are run again")
        return None
    except Exception:  # that of HDF5 for a foreign file depends on the file
        return None
