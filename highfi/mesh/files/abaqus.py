"""Meshes in input files of Abaqus and CalculiX: nodes, elements, sets and surfaces, in the file itself
or in parts that instances place.

A set has all members from any line of the file: elements under its ``*ELEMENT``, and numbers,
ranges and other sets under ``*ELSET``; so has a set of nodes with ``*NODE`` and ``*NSET``. Names of
sets do not depend on case. A ``*SURFACE`` of element faces or of nodes is a named group as well, and
so are instances and parts. See "Keywords reference" of the Abaqus guides.
"""

import meshio
import numpy as np

from tipoff.highfi.mesh.files import abaqus_types
from tipoff.highfi.mesh.files.abaqus_groups import gathered
from tipoff.highfi.mesh.files.abaqus_model import ROOT, Body, Model, Reference
from tipoff.highfi.mesh.files.abaqus_text import Keyword, keywords
from tipoff.highfi.mesh.files.tables import Unreadable, decoded, real, whole


def read(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a file. Raises Unreadable."""
    model = Model()
    for keyword in keywords(decoded(content)):
        _take(model, keyword)
    if not any(body.labels for body in model.bodies.values()):
        raise Unreadable("no *NODE, which an input file of Abaqus has")
    return gathered(model)


def _take(model: Model, keyword: Keyword) -> None:
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
            model.scope = keyword.of("NAME").upper()
            model.current = model.parts[model.scope] = Body()
        case "INSTANCE":
            _instance(model, keyword)
        case "END PART" | "END INSTANCE":
            model.current, model.scope = model.bodies[ROOT], ROOT


def _nodes(model: Model, keyword: Keyword) -> None:
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


def _elements(model: Model, keyword: Keyword) -> None:
    body, found = model.current, abaqus_types.known(keyword.of("TYPE"))
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


def _set(model: Model, keyword: Keyword, sets: dict[str, list[Reference]]) -> None:
    members = sets.setdefault(model.named(keyword.of(keyword.name)), [])
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


def _surface(model: Model, keyword: Keyword) -> None:
    kind = keyword.given.get("TYPE", "ELEMENT").upper()
    if kind == "NODE":
        nodes = model.current.node_sets.setdefault(model.named(keyword.of("NAME")), [])
        name = keyword.of("NAME").upper()
        found = [
            _reference(fields[0], model.scope, line) for line, fields in keyword.data if fields
        ]
        # a surface may have the name of its only set
        nodes += [one for one in found if (one.scope, one.name) != (model.scope, name)]
    if kind not in ("ELEMENT", "NODE") or "COMBINE" in keyword.given:
        given = f"COMBINE={keyword.given['COMBINE']}" if "COMBINE" in keyword.given else kind
        reason = f"line {keyword.line}: *SURFACE with {given}; write its elements and their sides"
        model.left_out[model.written[model.named(keyword.of("NAME"))]] = reason
    if kind != "ELEMENT" or "COMBINE" in keyword.given:
        return
    members = model.current.surfaces.setdefault(model.named(keyword.of("NAME")), [])
    for line, fields in keyword.data:
        if fields and fields[0]:
            face = fields[1].upper() if len(fields) > 1 else ""
            members.append((_reference(fields[0], model.scope, line), face))


def _instance(model: Model, keyword: Keyword) -> None:
    model.scope, part = keyword.of("NAME").upper(), keyword.given.get("PART", "").upper()
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
