"""Files of a rail compliance, and of its joint terms: arrays by name, without compression, because
that would hardly shorten numbers and takes most of the time of reading."""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.files import FORMAT, FORMAT_KEY, require_format, require_whole
from tipoff.mechanics.rail_compliance.joint_terms import JointTerms
from tipoff.mechanics.rail_compliance.nodal import Nodal, Tables

_PLAIN = ("made_for", "element_size", "frequency_uncertainty", "not_known")  # no arrays
# prefixes of the names of the joint terms and of the nodes in a file
_JOINTS, _NODES = "joints.", "nodes."


def content(fields: Mapping[str, Any]) -> bytes:
    """The file of the ``fields`` of a ``RailCompliance`` that are not None, without its digest."""
    known = {name: value for name, value in fields.items() if value is not None}
    if (nodes := known.pop("nodes", None)) is not None:
        known = {name: value for name, value in known.items() if name not in Tables._fields}
    return _written(known | _named(known.pop("joints", None), _JOINTS) | _named(nodes, _NODES))


def content_of_joints(terms: JointTerms) -> bytes:
    """The file of ``terms`` alone, without its digest."""
    return _written(_named(terms, _JOINTS))


def read(path: str | Path) -> dict[str, Any]:
    """The fields of a ``RailCompliance`` in a file. Raises FileNotFoundError, DamageError, and many
    kinds of exceptions for a foreign or damaged file."""
    found: dict[str, Any] = _arrays(path)
    if any(name.startswith(_JOINTS) for name in found):
        found["joints"] = _joints(found)
    if any(name.startswith(_NODES) for name in found):
        nodes = Nodal(*(found.pop(f"{_NODES}{name}") for name in Nodal._fields))
        found |= nodes.tables(found["rail"])._asdict() | {"nodes": nodes}
    return found | {name: found[name].item() for name in {*_PLAIN} & {*found}}


def plain_uncertainty(found: Mapping[str, Any]) -> dict[str, Any]:
    """The uncertainty of a compliance, its fields, as JSON."""
    known = found["uncertainty"]
    return {**found, "uncertainty": None if known is None else known.tolist()}


def uncertainty(found: Mapping[str, Any]) -> dict[str, Any]:
    """The fields that ``plain_uncertainty`` made JSON of."""
    known = found["uncertainty"]
    return {name: found[name] for name in ("frequency_uncertainty", "not_known")} | {
        "uncertainty": None if known is None else np.array(known)
    }


def read_joints(path: str | Path) -> JointTerms:
    """The joint terms in a file. Raises as ``read`` does."""
    return _joints(_arrays(path))


def _arrays(path: str | Path) -> dict[str, np.ndarray]:
    require_whole(path)
    with np.load(path, allow_pickle=False) as found:
        arrays = dict(found)
    require_format(path, arrays.pop(FORMAT_KEY, None))
    return arrays


def _named(terms: JointTerms | Nodal | None, prefix: str) -> dict[str, np.ndarray]:
    parts = terms._asdict() if terms is not None else {}
    return {f"{prefix}{name}": part for name, part in parts.items()}


def _joints(found: dict[str, Any]) -> JointTerms:
    """The joint terms, which leave ``found``."""
    return JointTerms(*(found.pop(f"{_JOINTS}{name}") for name in JointTerms._fields))


def _written(arrays: Mapping[str, Any]) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **{**arrays, FORMAT_KEY: FORMAT})
    return stream.getvalue()
