"""The same small rail in every format of mesh files. Formats that meshio writes with all groups are
written by it; gmsh 4.1 and names in Nastran and Abaqus follow the descriptions of these formats."""

import struct
from pathlib import Path
from typing import NamedTuple

import meshio
import numpy as np

from tipoff.meshes import bricks, msh

LENGTH, WIDTH, HEIGHT = 0.040, 0.020, 0.008
AREAS = {"mount": LENGTH * WIDTH, "contact": WIDTH * HEIGHT}  # m2
VOLUME, ELEMENTS = LENGTH * WIDTH * HEIGHT, 4 * 2 * 1


class Rail(NamedTuple):
    """A plate: ``mount`` is its lower face, ``contact`` the face at x = 0."""

    points: np.ndarray
    cells: np.ndarray
    surfaces: dict[str, np.ndarray]


def rail() -> Rail:
    """The plate in bricks."""
    borders = [np.linspace(0.0, LENGTH, 5), np.linspace(0.0, WIDTH, 3), np.array([0.0, HEIGHT])]
    points, cells = bricks.filled(borders, np.ones((4, 2, 1), dtype=bool))
    places = points[cells]
    surfaces = {}
    for name, axis in (("mount", 2), ("contact", 0)):
        faces = np.array(
            [
                cell[np.isclose(place[:, axis], 0.0)]
                for cell, place in zip(cells, places)
                if np.isclose(place[:, axis], 0.0).any()
            ]
        )
        surfaces[name] = np.array([_around(points, face) for face in faces])
    return Rail(points, cells, surfaces)


def _around(points: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Corners in order around their middle."""
    away = points[face] - points[face].mean(axis=0)
    first, second = np.argsort(np.ptp(away, axis=0))[1:]
    return face[np.argsort(np.arctan2(away[:, second], away[:, first]))]


def _meshio(form: str, path: Path) -> None:
    meshio.gmsh.write(path, msh.tagged(*rail()), "2.2", binary=form.endswith("binary"))


def gmsh_41(halves: bool = False, binary: bool = False) -> bytes:
    """Format 4.1, in which the entity of a face may be in several groups: with ``halves`` the mount is
    two entities, one of which is also in the group ``bolts`` and the other reversed."""
    points, cells, surfaces = rail()
    mount = surfaces["mount"]
    faces = [(surfaces["contact"], [2])]
    faces += [(mount[:4], [1, 3]), (mount[4:], [-3])] if halves else [(mount, [3])]

    def pack(kind: str, *numbers) -> bytes:
        if binary:
            return struct.pack(f"<{len(numbers)}{kind}", *numbers)
        return (" ".join(repr(number) for number in numbers) + "\n").encode()

    box = (0.0, 0.0, 0.0, LENGTH, WIDTH, HEIGHT)
    entities = pack("Q", 0, 0, len(faces), 1)
    for dimension, groups in ((2, [tags for _, tags in faces]), (3, [[9]])):
        for number, tags in enumerate(groups, start=1):
            entities += pack("i", number) + pack("d", *box) + pack("Q", len(tags))
            entities += pack("i", *tags) + pack("Q", 0)
        assert dimension
    nodes = pack("Q", 1, len(points), 1, len(points)) + pack("i", 3, 1, 0) + pack("Q", len(points))
    nodes += pack("Q", *range(1, len(points) + 1)) + pack("d", *points.ravel().tolist())
    blocks = [(2, number, 3, found) for number, (found, _) in enumerate(faces, start=1)]
    blocks.append((3, 1, 5, cells))
    total = sum(len(found) for *_, found in blocks)
    elements, label = pack("Q", len(blocks), total, 1, total), 0
    for dimension, entity, kind, found in blocks:
        elements += pack("i", dimension, entity, kind) + pack("Q", len(found))
        for row in found + 1:
            label += 1
            elements += pack("Q", label, *row.tolist())
    names = b'4\n2 1 "bolts"\n2 2 "contact"\n2 3 "mount"\n3 9 "rail"\n'
    start = b"4.1 1 8\n" + struct.pack("<i", 1) + b"\n" if binary else b"4.1 0 8\n"
    sections = [("MeshFormat", start), ("PhysicalNames", names), ("Entities", entities)]
    sections += [("Nodes", nodes), ("Elements", elements)]
    end = b"\n" if binary else b""
    return b"".join(
        b"$%s\n%s%s$End%s\n"
        % (name.encode(), content, end if name > "E" and binary else b"", name.encode())
        for name, content in sections
    )


def abaqus(elements: str = "*ELEMENT, TYPE=S4, ELSET={name}") -> str:
    """An input file whose facets are shells, each group below a keyword of its own."""
    points, cells, surfaces = rail()
    lines = ["*HEADING", "a rail", "** a comment", "*NODE"]
    lines += [f"{number}, {x:.9g}, {y:.9g}, {z:.9g}" for number, (x, y, z) in enumerate(points, 1)]
    lines += ["*Element, type=C3D8R"]
    lines += [", ".join(map(str, [number, *(row + 1)])) for number, row in enumerate(cells, 1)]
    label = len(cells)
    for name, facets in surfaces.items():
        lines.append(elements.format(name=name))
        for row in facets + 1:
            label += 1
            lines.append(", ".join(map(str, [label, *row])))
    return "\n".join(lines) + "\n"


def nastran(width: int = 8) -> str:
    """Bulk data in fields of 8 or 16 columns, or free with commas for 0 and with blanks for 1, with
    the names that Femap writes."""
    points, cells, surfaces = rail()
    lines = ["SOL 101", "CEND", "BEGIN BULK"]
    lines += [f"$ Femap Property {owner} : {name}" for owner, name in enumerate(surfaces, 2)]
    for number, point in enumerate(points, 1):
        lines += _card("GRID", [number, "", *(f"{place:.4f}" for place in point)], width)
    label = 0
    blocks = [("CHEXA", 1, cells), *(("CQUAD4", n, f) for n, f in enumerate(surfaces.values(), 2))]
    for name, owner, found in blocks:
        for row in found + 1:
            label += 1
            shell = [0.0] if name == "CQUAD4" else []  # an angle behind the nodes
            lines += _card(name, [label, owner, *row.tolist(), *shell], width)
    lines += ["PSHELL  2       1       .001", "PSHELL  3       1       .001", "PSOLID  1       1"]
    return "\n".join([*lines, "ENDDATA", ""])


def _card(name: str, fields: list, width: int) -> list[str]:
    count = 4 if width == 16 else 8
    rows = [fields[at : at + count] for at in range(0, len(fields), count)]
    lines = []
    for number, row in enumerate(rows):
        first = (name if number == 0 else "+") + ("*" if width == 16 and number == 0 else "")
        first = "*" if width == 16 and number else first
        if width < 2:  # blanks cannot stand for an empty field
            texts = [str(field) or ("0" if width else "") for field in row]
            lines.append(", "[width].join([first, *texts]))
        else:
            lines.append(f"{first:8}" + "".join(f"{field!s:>{width}}" for field in row))
    return lines


def write(form: str, path: Path) -> Path:
    """The plate as a file without suffix ``path`` and with that of the format."""
    file = path.with_suffix(FORMS[form])
    if form.startswith("gmsh 4.1"):
        file.write_bytes(gmsh_41(halves=True, binary=form.endswith("binary")))
    elif form.startswith("Abaqus"):
        file.write_text(abaqus(), encoding="utf-8")
    elif form.startswith("Nastran"):
        width = {"small": 8, "large": 16, "free": 0, "blanks": 1}[form.split()[1]]
        file.write_text(nastran(width), encoding="utf-8")
    else:
        _meshio(form, file)
    return file


FORMS = {
    "gmsh 2.2 text": ".msh",
    "gmsh 2.2 binary": ".msh",
    "gmsh 4.1 text": ".msh",
    "gmsh 4.1 binary": ".msh",
    "Abaqus": ".inp",
    "Nastran small": ".bdf",
    "Nastran large": ".nas",
    "Nastran free": ".dat",
    "Nastran blanks": ".bdf",
}
