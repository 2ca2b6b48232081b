"""Which cases of a store lie outside what the calibration was made for, kept in the store beside their results, case by case::

    cases.zarr/outside_calibration   (n,) bool, one chunk; attributes: long_name, judged_by (the ranges, their margin and the
                                     digest of rail and pads; null where nothing was fitted), digest (SHA-256 of the marks)

No number of a store depends on them, so they are no part of its identity and of the checksums of its chunks: a store that is used
with another calibration is judged anew. Their own digest tells marks that a kill left half written, which no reader takes.
"""

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lowfi.store import StoreError
from scenes import validity
from scenes.calibration import Calibration

NAME = "outside_calibration"
WORDS = "whether a case lies outside what the calibration was made for"


class Marks(NamedTuple):
    """``outside`` (n,) bool, and what the cases were ``judged_by``: ranges (SI) of the fit by name, their margin as a share of
    their ends, and the digest of rail and pads; None where nothing was fitted."""

    outside: np.ndarray
    judged_by: dict | None


def keep(store: Path, outside: np.ndarray, fitted: Calibration | None) -> None:
    """Keep the marks (n,) of the cases of a store, as judged by a calibration or by None, to which nothing was fitted; they are
    left alone where they are the same.

    Raises StoreError where that fails, as on a full disk.
    """
    import zarr

    judged = fitted and {"ranges_si": {name: [float(end) for end in span] for name, span in fitted.valid.items()},
                         "margin": validity.MARGIN, "geometry_hash": fitted.provenance.get("geometry_hash")}
    if _same(store, outside, judged):
        return
    try:
        place = zarr.open_group(store / "cases.zarr", mode="r+").create_array(
            NAME, shape=outside.shape, chunks=(max(outside.size, 1),), dtype=bool, fill_value=False, overwrite=True,
            dimension_names=("case",), attributes={"long_name": WORDS, "judged_by": judged, "digest": _digest(outside)})
        place[:] = outside
    except OSError as error:
        raise StoreError(f"cannot write {store}: {error.strerror or error}") from error


def kept(store: Path) -> Marks:
    """The marks of a store. Raises StoreError where it has none, or damaged ones."""
    import zarr

    try:
        place = zarr.open_group(store / "cases.zarr", mode="r")[NAME]
        outside, attributes = place[:], dict(place.attrs)
        if _digest(outside) != attributes["digest"]:
            raise ValueError("they are not those of their digest")
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise StoreError(f"{store} says of no case whether it is outside the calibration ({type(error).__name__}: {error}); "
                         "the study that made it writes that again") from error
    return Marks(outside, attributes["judged_by"])


def _same(store: Path, outside: np.ndarray, judged: dict | None) -> bool:
    try:
        known = kept(store)
    except StoreError:  # none yet, or damaged ones: the remedy is the same
        return False
    return known.judged_by == judged and np.array_equal(known.outside, outside)


def _digest(outside: np.ndarray) -> str:
    return hashlib.sha256(np.ascontiguousarray(outside, dtype=bool)).hexdigest()
