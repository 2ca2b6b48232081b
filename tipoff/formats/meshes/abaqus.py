"""Meshes in input files of Abaqus and CalculiX: nodes, elements, sets and surfaces, in the file itself
or in parts that instances place.

A set has all members from any line of the file: elements under its ``*ELEMENT``, and numbers,
ranges and other sets under ``*ELSET``; so has a set of nodes with ``*NODE`` and ``*NSET``. Names of
sets do not depend on case. A ``*SURFACE`` of element faces or of nodes is a named group as well, and
so are instances and parts. See "Keywords reference" of the Abaqus guides.
Element types are in section "Element library".
"""

import re
from collections.abc import Iterator
from typing import NamedTuple

import meshio
import numpy as np

from tipoff.formats.meshes.abaqus_groups import ROOT, Body, Model, Reference, gathered
from tipoff.formats.meshes.blocks import MeshFormat, Unreadable, decoded, real, require_end, whole

# Keywords that make or move nodes or elements in ways that are not read here.
_MAKERS = {
    *("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "IMPORT", "INCLUDE"),
    *("PARAMETER", "SUBMODEL", "SUBSTRUCTURE"),
}
_SOLIDS = {
    4: "tetra",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    15: "wedge15",
    20: "hexahedron20",
    27: "hexahedron27",
}
_FACES = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}
_SOLID = re.compile(r"^(?:C3D|DC3D|AC3D)(\d+)[A-Z]*$")
_FACE = re.compile(r"^(?:S|M3D|SFM3D|R3D|CPS|CPE|CAX|DS|DC2D)(\d)[A-Z]*\d?$")
_TRIANGULAR_SHELLS = {"STRI3": 3, "STRI65": 6}
# elements of lines and points, which carry no surface
_OTHER = re.compile(
    r"^(?:T2D|T3D|B2|B3|PIPE|ELBOW|FRAME|R2D|RAX|RB|MASS|ROTARYI|SPRING|DASHPOT|GAP|CONN|DCOUP|"
    r"SAX|HEATCAP|D$|U1$)"
)


class _Keyword(NamedTuple):
    """A keyword with its parameters and data."""

    name: str  # capitals, without the star
    given: dict[str, str]  # parameters in capitals; a value may be empty
    data: list[tuple[int, list[str]]]  # number of a line and its fields
    line: int

    def required(self, parameter: str) -> str:
        """Value of a required parameter. Raises Unreadable without it."""
        value = self.given.get(parameter, "")
        if not value:
            raise Unreadable(f"line {self.line}: *{self.name} without {parameter}=")
        return value


def _keywords(text: str) -> Iterator[_Keyword]:
    """The keywords of a file in their order. Raises Unreadable for keywords that make or move nodes
    and elements."""
    current: _Keyword | None = None
    header, start = "", 0
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if header and not line.startswith("*"):  # parameters go on behind a comma
            header += line
        elif line.startswith("*"):
            if current is not None:
                yield current
            header, start = line, number
        else:
            if current is None:
                raise Unreadable(f"line {number}: data before the first keyword")
            fields = [field.strip() for field in line.split(",")]
            current.data.append((number, fields[:-1] if fields[-1] == "" else fields))
            continue
        if header.endswith(","):
            current = None
            continue
        current, header = _keyword(header, start), ""
    if current is not None:
        yield current


def _keyword(header: str, line: int) -> _Keyword:
    name, *parameters = [part.strip() for part in header[1:].split(",")]
    given = {}
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        given[key.strip().upper()] = value.strip().strip('"')
    name = " ".join(name.upper().split())
    is_elsewhere = name in ("NODE", "ELEMENT", "ELSET", "SURFACE") and "INPUT" in given
    if name in _MAKERS or is_elsewhere:
        raise Unreadable(
            f"line {line}: *{name}{' with INPUT' * is_elsewhere} is not read; write the file with all "
            "nodes, elements and sets in it"
        )
    return _Keyword(name, given, [], line)


def read_abaqus(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a file. Raises Unreadable."""
    model, text = Model(), decoded(content)
    require_end(text, ("*",))
    for keyword in _keywords(text):
        _take(model, keyword)
    if not any(body.labels for body in model.bodies.values()):
        raise Unreadable("no *NODE, which an input file of Abaqus has")
    return gathered(model)


def _take(model: Model, keyword: _Keyword) -> None:
    match keyword.name:
        case "NODE":
            _nodes(model, keyword)
        case "ELEMENT":
            _elements(model, keyword)
        case "ELSET":
            _set(model, keyword, model.current.sets)
        case "NSET":
            _set(model, keyword, model.current.node_sets)
        case "SURFACE":
            _surface(model, keyword)
        case "PART":
            model.scope = keyword.required("NAME").upper()
            model.current = model.parts[model.scope] = Body()
        case "INSTANCE":
            _instance(model, keyword)
        case "END PART" | "END INSTANCE":
            model.current, model.scope = model.bodies[ROOT], ROOT


def _nodes(model: Model, keyword: _Keyword) -> None:
    body = model.current
    if keyword.given.get("SYSTEM", "R").upper() != "R":
        raise Unreadable(f"line {keyword.line}: *NODE in a system that is not rectangular")
    first = len(body.labels)
    for line, fields in keyword.data:
        body.labels.append(whole(fields[0], line))
        places = [real(field, line) for field in fields[1:4]]
        body.points.append(places + [0.0] * (3 - len(places)))
    if name := keyword.given.get("NSET"):
        _add(model, body.node_sets, name, body.labels[first:], keyword.line)


def _add(
    model: Model, sets: dict[str, list[Reference]], name: str, labels: list[int], line: int
) -> None:
    """Add elements or nodes to the set that their own keyword names."""
    lines = [Reference(model.scope, range(one, one + 1), "", line) for one in labels]
    sets.setdefault(model.named(name), []).extend(lines)


def _elements(model: Model, keyword: _Keyword) -> None:
    body, found = model.current, _element_type(keyword.required("TYPE"))
    labels = []
    if found is None:
        labels = [whole(fields[0], line) for line, fields in keyword.data]
        body.others.update(labels)
    else:
        kind, nodes = found
        members = body.elements.setdefault(kind, {})
        row: list[int] = []
        for line, fields in keyword.data:
            row += [whole(field, line) for field in fields]
            if len(row) > nodes + 1:
                raise Unreadable(
                    f"line {line}: {len(row) - 1} nodes of an element of {nodes} ({kind})"
                )
            if len(row) == nodes + 1:
                label, own = row[0], tuple(row[1:])
                if body.has(label) and members.get(label) != own:
                    raise Unreadable(f"line {line}: a second element {label}")
                members[label] = own
                labels.append(label)
                row = []
        if row:
            raise Unreadable(f"the last element of *ELEMENT in line {keyword.line} lacks nodes")
    if name := keyword.given.get("ELSET"):
        _add(model, body.sets, name, labels, keyword.line)


def _set(model: Model, keyword: _Keyword, sets: dict[str, list[Reference]]) -> None:
    members = sets.setdefault(model.named(keyword.required(keyword.name)), [])
    if keyword.name == "NSET" and "ELSET" in keyword.given:
        raise Unreadable(f"line {keyword.line}: *NSET of an element set; write its nodes")
    scope = keyword.given.get("INSTANCE", model.scope).upper()
    for line, fields in keyword.data:
        if "GENERATE" in keyword.given:
            numbers = [whole(field, line) for field in fields]
            first, last, step = (*numbers, 1)[:3] if len(numbers) in (2, 3) else (0, 0, 0)
            if step < 1 or last < first:
                raise Unreadable(f"line {line}: GENERATE needs first, last and step")
            members.append(Reference(scope, range(first, last + 1, step), "", line))
        else:
            members += [_reference(field, scope, line) for field in fields if field]


def _reference(field: str, scope: str, line: int) -> Reference:
    """An element, a node or a set, with an optional instance in front."""
    owner, _, rest = field.strip('"').rpartition(".")
    if rest.isdigit():
        number = whole(rest, line)
        return Reference(owner.upper() or scope, range(number, number + 1), "", line)
    if owner:
        return Reference(owner.upper(), range(0), rest.upper(), line)
    return Reference(scope, range(0), field.strip('"').upper(), line)


def _surface(model: Model, keyword: _Keyword) -> None:
    kind = keyword.given.get("TYPE", "ELEMENT").upper()
    if kind == "NODE":
        nodes = model.current.node_sets.setdefault(model.named(keyword.required("NAME")), [])
        name = keyword.required("NAME").upper()
        found = [
            _reference(fields[0], model.scope, line) for line, fields in keyword.data if fields
        ]
        # a surface may have the name of its only set
        nodes += [one for one in found if (one.scope, one.name) != (model.scope, name)]
    if kind not in ("ELEMENT", "NODE") or "COMBINE" in keyword.given:
        given = f"COMBINE={keyword.given['COMBINE']}" if "COMBINE" in keyword.given else kind
        reason = f"line {keyword.line}: *SURFACE with {given}; write its elements and their sides"
        model.left_out[model.written[model.named(keyword.required("NAME"))]] = reason
    if kind != "ELEMENT" or "COMBINE" in keyword.given:
        return
    members = model.current.surfaces.setdefault(model.named(keyword.required("NAME")), [])
    for line, fields in keyword.data:
        if fields and fields[0]:
            face = fields[1].upper() if len(fields) > 1 else ""
            members.append((_reference(fields[0], model.scope, line), face))


def _instance(model: Model, keyword: _Keyword) -> None:
    model.scope, part = keyword.required("NAME").upper(), keyword.given.get("PART", "").upper()
    if part and part not in model.parts:
        raise Unreadable(f"line {keyword.line}: no part {part}")
    model.current = model.bodies[model.scope] = body = Body(part)
    if not part:
        return
    source = model.parts[part]
    numbers = [[real(field, line) for field in fields] for line, fields in keyword.data]
    points = _placed(np.reshape(source.points, (-1, 3)), numbers, keyword.line)
    body.labels, body.points = list(source.labels), points.tolist()
    body.elements = {kind: dict(found) for kind, found in source.elements.items()}
    body.others = set(source.others)
    here = model.scope
    body.sets, body.node_sets = (
        {name: [one._replace(scope=here) for one in found] for name, found in sets.items()}
        for sets in (source.sets, source.node_sets)
    )
    body.surfaces = {
        name: [(one._replace(scope=here), face) for one, face in found]
        for name, found in source.surfaces.items()
    }


def _placed(points: np.ndarray, numbers: list[list[float]], line: int) -> np.ndarray:
    """Points moved by the first line of an instance, then turned about an axis between two points by
    the angle (degrees) in the second."""
    if [len(each) for each in numbers] not in ([], [3], [3, 7]):
        raise Unreadable(f"line {line}: an instance has three numbers, then seven")
    if numbers:
        points = points + numbers[0]
    if len(numbers) == 2:
        start, end, angle = np.array(numbers[1][:3]), np.array(numbers[1][3:6]), numbers[1][6]
        axis = (end - start) / (np.linalg.norm(end - start) or np.nan)
        turned, radians = points - start, np.deg2rad(angle)
        # Rodrigues' formula
        points = (
            start
            + turned * np.cos(radians)
            + np.cross(axis, turned) * np.sin(radians)
            + np.outer(turned @ axis, axis) * (1.0 - np.cos(radians))
        )
    return points


def _element_type(name: str) -> tuple[str, int] | None:
    """Name in meshio and number of nodes of an element type; None for elements of lines and points.

    Raises Unreadable for a type that is not known, which may be a solid.
    """
    plain = name.upper()
    if found := _SOLID.match(plain):
        nodes, names = int(found[1]), _SOLIDS
    elif plain in _TRIANGULAR_SHELLS:
        nodes, names = _TRIANGULAR_SHELLS[plain], _FACES
    elif found := _FACE.match(plain):
        nodes, names = int(found[1]), _FACES
    else:
        if _OTHER.match(plain):
            return None
        nodes, names = 0, {}
    if nodes not in names:
        raise Unreadable(
            f"elements of type {name[:40]}, which are not known; solids are C3D8 or C3D10, surfaces "
            "are shells such as S4 or STRI65"
        )
    return names[nodes], nodes


FORMATS = (
    MeshFormat(
        "Abaqus",
        read_abaqus,
        [
            (
                "Abaqus, CalculiX `.inp`",
                "`*NODE`, `*ELEMENT`, `*PART`, `*INSTANCE` with its place and rotation",
                "`*ELSET` of shells, `*NSET`, `*SURFACE` of sides `S1`... or of nodes; "
                "`GENERATE`, sets of sets",
            )
        ],
        suffixes=(".inp",),
    ),
)
