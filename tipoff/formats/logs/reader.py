"""Reads a log of a sensor from a file of any format, chosen by the suffix of its name."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tipoff.formats.declared import declared, of_suffix


def read_log(
    path: Path, names: Mapping[str, tuple[str, ...]], units: Mapping[str, str | None]
) -> tuple[dict[str, np.ndarray], list[str]]:
    """The channels of a file in SI and notes, as ``sensor_log.read_sensor_log``. Raises SceneError with
    every fault."""
    found = of_suffix(declared(__package__), path)
    assert found is not None  # one format reads any file
    return found.read(path, names, units)
