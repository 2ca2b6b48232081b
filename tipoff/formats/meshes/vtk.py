"""Meshes in files of VTK (``.vtu``, ``.vtk``), read by meshio.

The format has no groups. An array of integers with one value for each cell gives a group for every value,
such as ``CellEntityIds = 2``. Cells, or points, where an array is not zero are a group with its name.
"""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import MeshFormat, Unreadable, any_case

_MOST = 1000  # values of an array that are groups


def read_vtu(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a ``.vtu`` file. Raises Unreadable."""
    return _read(content, meshio.vtu.read)


def read_vtk(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a ``.vtk`` file. Raises Unreadable."""
    return _read(content, meshio.vtk.read)


def _read(content: bytes, reader: Callable[[Any], meshio.Mesh]) -> meshio.Mesh:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "mesh")
        path.write_bytes(content)
        try:
            found = reader(path)
        except MemoryError:
            raise
        except (Exception, SystemExit) as fault:
            why = (str(fault).splitlines() or [type(fault).__name__])[0]
            raise Unreadable(f"meshio does not read it ({why[:150]})") from fault
    points = np.asarray(found.points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise Unreadable("points that do not have three coordinates")
    for block in found.cells:
        if block.type.startswith("polyhedron"):
            raise Unreadable("polyhedra, which are not read; write hexahedra or tetrahedra")
        data = np.asarray(block.data)
        if data.size and not 0 <= data.min() <= data.max() < len(points):
            raise Unreadable(f"elements of type {block.type} with points that do not exist")
    groups: dict[str, list[np.ndarray]] = {}
    for name, parts in found.cell_data.items():
        every = [np.asarray(part) for part in parts]
        if any(part.ndim != 1 or part.dtype.kind not in "iufb" for part in every):
            continue
        groups[any_case(name) or name] = [np.flatnonzero(part) for part in every]
        values = np.unique(np.concatenate(every)) if every else np.empty(0)
        if len(values) <= _MOST and (values == values.round()).all():
            for value in values.tolist():
                groups[f"{name} = {int(value)}"] = [np.flatnonzero(part == value) for part in every]
    nodes = {
        any_case(name) or name: np.flatnonzero(part)
        for name, part in found.point_data.items()
        if np.ndim(part) == 1 and np.asarray(part).dtype.kind in "iufb"
    }
    return meshio.Mesh(points, found.cells, cell_sets=groups, point_sets=nodes)


_GROUPS = (
    "arrays that mark cells or points by a value other than 0; values of integers, "
    "`CellEntityIds = 2`"
)
FORMATS = (
    MeshFormat(
        "VTK",
        read_vtu,
        [("VTK `.vtu`, `.vtk`", "as meshio reads them", _GROUPS)],
        suffixes=(".vtu",),
    ),
    MeshFormat("VTK", read_vtk, (), suffixes=(".vtk",)),
)
