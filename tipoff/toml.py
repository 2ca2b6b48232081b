"""Writing TOML, which the standard library only reads."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import tomlkit


def dumps(table: Mapping[str, Any]) -> str:
    """TOML of a table of text, booleans, numbers, lists and tables; NumPy's scalars are numbers.
    Raises ValueError for a NaN and TypeError for a value of any other type."""
    return tomlkit.dumps(_plain(table))


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and math.isnan(value):
        raise ValueError("a value is NaN")
    return value
