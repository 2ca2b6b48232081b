"""Arrays of a store: one chunk of cases in one file, with a checksum."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.lowfi.ensemble import columns

NOT_RUN = -1


def kind(name: str) -> str:
    """Type of the numbers of a result."""
    return {"status": "i1", "steps": "i8"}.get(name, "f8")


def create(
    group: Any, name: str, cases: int, chunk: int, attributes: Mapping[str, Any], type_: str = "f8"
) -> Any:
    """A new empty array of ``cases`` rows in a zarr group, with ``chunk`` rows per file."""
    from zarr.codecs import Crc32cCodec

    inner = (3,) if name in columns.VECTORS else ()
    return group.create_array(
        name,
        shape=(cases, *inner),
        chunks=(chunk, *inner),
        dtype=type_,
        compressors=[Crc32cCodec()],
        fill_value=np.nan if type_ == "f8" else NOT_RUN,
        attributes=dict(attributes),
        dimension_names=("case", "axis")[: 1 + len(inner)],
    )


def exchange(new: Path, place: Path, aside: Path) -> None:
    """Put the folder ``new`` in ``place`` and the one there ``aside``, which comes back if that
    fails. No folder is replaced in one step where it has files."""
    if was_there := place.exists():
        os.replace(place, aside)
    try:
        os.replace(new, place)
    except BaseException:
        if was_there:
            os.replace(aside, place)
        raise
