"""Meshes in MED files of Salome and Code_Aster, which are HDF5.

    ENS_MAA/MESH[/STEP]/NOE/COO, FAM          coordinates and family of each node
    ENS_MAA/MESH[/STEP]/MAI/TYPE/NOD, FAM     nodes and family of each element of a type
    FAS/MESH/ELEME/FAMILY, NOEUD/FAMILY       number of a family; the names of its groups in GRO/NOM

Arrays of several components have one component after the other. The faces of a solid in MED are turned the
other way than in VTK, but some writers do not turn them. So each solid is taken with the order of nodes
that gives it a positive volume. See the MED file documentation of Salome, "Modélisation".
"""

import io
from typing import TYPE_CHECKING

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import Block, MeshFormat, Unreadable, any_case, joined_mesh

if TYPE_CHECKING:
    import h5py

# name in meshio, nodes
_TYPES = {
    "TR3": ("triangle", 3),
    "TR6": ("triangle6", 6),
    "TR7": ("triangle7", 7),
    "QU4": ("quad", 4),
    "QU8": ("quad8", 8),
    "QU9": ("quad9", 9),
    "TE4": ("tetra", 4),
    "T10": ("tetra10", 10),
    "HE8": ("hexahedron", 8),
    "H20": ("hexahedron20", 20),
    "H27": ("hexahedron27", 27),
    "PE6": ("wedge", 6),
    "P15": ("wedge15", 15),
    "P18": ("wedge18", 18),
    "PY5": ("pyramid", 5),
    "P13": ("pyramid13", 13),
}
# corners, and middle nodes of tetrahedra, in the other turn
_TURNED = {"tetra": [0, 2, 1, 3], "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]}
_HEXAHEDRON = [0, 3, 2, 1, 4, 7, 6, 5]
_OTHER = ("PO1", "SE2", "SE3", "SE4")  # points and lines


def read_med(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a file. Raises Unreadable."""
    import h5py

    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            return _read(file)
    except (KeyError, OSError, TypeError, AttributeError, RuntimeError) as fault:
        why = str(fault).strip("'\"").splitlines() or [""]
        raise Unreadable(f"it is damaged or no MED file ({why[0][:100]})") from fault


def _read(file: "h5py.File") -> meshio.Mesh:
    names = list(file["ENS_MAA"])
    if len(names) != 1:
        raise Unreadable(
            f"{len(names)} meshes in one file, {', '.join(names)[:100]}; write the rail alone"
        )
    body = file["ENS_MAA"][names[0]]
    if "NOE" not in body:
        steps = list(body)
        if len(steps) != 1:
            raise Unreadable(f"a mesh with {len(steps)} time steps, where one is read")
        body = body[steps[0]]
    points = _table(body["NOE"]["COO"], 3).astype(float)
    labels = np.arange(1, len(points) + 1)
    blocks, families = [], []
    for name in body.get("MAI", ()):
        if name in _OTHER:
            continue
        if name not in _TYPES:
            raise Unreadable(f"elements of type {name[:20]}, which are not known")
        kind, count = _TYPES[name]
        nodes = _table(body["MAI"][name]["NOD"], count).astype(np.int64)
        if nodes.size and not 0 < nodes.min() <= nodes.max() <= len(points):
            raise Unreadable(f"elements of type {name} with nodes that do not exist")
        blocks.append(Block(kind, np.arange(len(nodes)), _outward(kind, points, nodes)))
        families.append(_families(body["MAI"][name], len(nodes)))
    groups: dict[str, list[np.ndarray]] = {}
    given = file["FAS"][names[0]] if "FAS" in file and names[0] in file["FAS"] else {}
    for name, numbers in _names(given, "ELEME").items():
        groups[name] = [np.flatnonzero(np.isin(family, numbers)) for family in families]
    own = _families(body["NOE"], len(points))
    sets = {name: labels[np.isin(own, numbers)] for name, numbers in _names(given, "NOEUD").items()}
    return joined_mesh(labels, points, blocks, groups, sets)


def _table(data: "h5py.Dataset", width: int) -> np.ndarray:
    """Array (n,width) whose columns follow each other in the file."""
    found = np.asarray(data[()]).ravel()
    if len(found) % width:
        raise Unreadable(f"{len(found)} numbers in {data.name[-30:]}, which has {width} columns")
    return found.reshape(width, -1).T


def _families(part: "h5py.Group", count: int) -> np.ndarray:
    """Number (n,) of the family of each node or element; 0 is that without groups."""
    if "FAM" not in part:
        return np.zeros(count, dtype=np.int64)
    found = np.asarray(part["FAM"][()]).astype(np.int64).ravel()
    if len(found) != count:
        raise Unreadable(f"{len(found)} families of {count} nodes or elements")
    return found


def _names(families: "h5py.Group", kind: str) -> dict[str, list[int]]:
    """Numbers of the families of each group."""
    found: dict[str, list[int]] = {}
    for family in families[kind].values() if kind in families else ():
        if "GRO" in family:
            for row in np.asarray(family["GRO"]["NOM"][()]).astype(np.uint8).reshape(-1, 80):
                name = bytes(row).split(b"\0")[0].decode("utf-8", "replace").strip()
                number = int(np.ravel(family.attrs["NUM"])[0])
                found.setdefault(any_case(name) or name, []).append(number)
    return found


def _outward(kind: str, points: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Nodes (e,k) of solids in the order that gives a positive volume."""
    order = _TURNED.get(kind)
    if kind.startswith("hexahedron"):
        order = [*_HEXAHEDRON, *range(8, nodes.shape[1])]
    if order is None:
        return nodes
    # of a hexahedron, with three edges at a corner; both kinds have the fourth corner above the base
    above = 4 if kind.startswith("hexahedron") else 3
    ends = [1, 3, above] if above == 4 else [1, 2, above]
    corners = points[nodes - 1]
    with np.errstate(over="ignore", invalid="ignore"):
        volume = np.linalg.det(corners[:, ends] - corners[:, :1])
    return np.where(volume[:, None] < 0.0, nodes[:, order], nodes)


FORMATS = (
    MeshFormat(
        "Salome",
        read_med,
        [
            (
                "Salome, Code_Aster `.med`",
                "one mesh, one time step",
                "groups of elements or nodes",
            )
        ],
        suffixes=(".med",),
    ),
)
