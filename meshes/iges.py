"""Solids from IGES files. Such a file gives faces that share no edges, so the faces are sewn.

An edge of a closed surface belongs to two faces, or twice to one face that closes on itself. Sewn
faces that are connected by edges are the surface of one solid if every edge obeys this rule.
"""

import re
from collections import Counter
from pathlib import Path

SUFFIXES = (".iges", ".igs")
_GAP = 1e-6  # m, largest distance between edges of two faces that are sewn
_POINT = 1e-12  # m; a shorter edge is the tip of a cone or the pole of a sphere
_WAY_OUT = "export the solid as STEP"
_TEXT = re.compile(r" *(\d+)H")  # before a text, its number of characters
_SCALE = 12  # place of the scale of the model among the global parameters


def load(gmsh, path: Path) -> None:
    """Read the solids of an IGES file into the current model of gmsh, in metres.

    Raises ValueError for a model at another scale than 1, for faces that do not close, for solids
    that touch or contain each other, and for faces of which gmsh makes no solids; gmsh raises
    Exception for a file that it does not read.
    """
    if (scale := (_global_parameters(path)[_SCALE:] or [""])[0]) and not _is_one(scale):
        # gmsh takes the lengths of the model as those of the part.
        raise ValueError(f"its model has the scale {scale}, where 1 is expected; {_WAY_OUT}")
    # gmsh sets the unit of its kernel before it starts the kernel's reader of IGES, which must
    # exist. So the first file of a process fails with a unit, but not without one.
    unit = gmsh.option.getString("Geometry.OCCTargetUnit")
    gmsh.option.setString("Geometry.OCCTargetUnit", "")
    gmsh.model.add("units")
    gmsh.model.occ.importShapes(str(path))
    gmsh.model.remove()
    gmsh.option.setString("Geometry.OCCTargetUnit", unit)
    tolerance = gmsh.option.getNumber("Geometry.Tolerance")
    gmsh.option.setNumber("Geometry.OCCSewFaces", 1)
    gmsh.option.setNumber("Geometry.Tolerance", _GAP)
    try:
        gmsh.model.occ.importShapes(str(path))
    finally:
        gmsh.option.setNumber("Geometry.OCCSewFaces", 0)
        gmsh.option.setNumber("Geometry.Tolerance", tolerance)
    gmsh.model.occ.removeAllDuplicates()
    gmsh.model.occ.synchronize()
    # Files may hold solids as such (entity 186) beside or instead of loose faces.
    owned = {abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(3), False)}
    loose = [tag for _, tag in gmsh.model.getEntities(2) if tag not in owned]
    if not loose:
        return
    for shell in _shells(gmsh, loose):
        surface = gmsh.model.occ.addSurfaceLoop(shell, sewing=True)
        gmsh.model.occ.addVolume([surface])
    gmsh.model.occ.synchronize()
    _check_apart(gmsh)


def _global_parameters(path: Path) -> list[str]:
    """The parameters of the global section, without trailing ones that the file omits. The first
    two are the separators; empty ones mean a comma and a semicolon."""
    lines = path.read_text(encoding="latin-1").splitlines()
    text = "".join(line[:72].ljust(72) for line in lines if line[72:73] == "G")
    found: list[str] = []
    between, last, at = ",", ";", 0
    while at < len(text):
        start, stop = at, at
        if written := _TEXT.match(text, at):  # it may contain separators
            start, stop = written.end(), written.end() + int(written[1])
        while stop < len(text) and text[stop] not in (between, last) and not written:
            stop += 1
        found.append(text[start:stop].strip())
        if len(found) == 1:
            between = found[0][:1] or between
        elif len(found) == 2:
            last = found[1][:1] or last
        ends = [place for mark in (between, last) if (place := text.find(mark, stop)) >= 0]
        if not ends or text[min(ends)] == last:
            break
        at = min(ends) + 1
    return found


def _is_one(number: str) -> bool:
    try:
        return float(number.upper().replace("D", "E")) == 1.0
    except ValueError:
        return False


def _shells(gmsh, faces: list[int]) -> list[list[int]]:
    """Groups of faces that are connected by edges. Raises ValueError for edges of one face, or of
    more than two."""
    edges = {
        face: [abs(edge) for _, edge in gmsh.model.getBoundary([(2, face)], combined=False)]
        for face in faces
    }
    times = Counter(edge for around in edges.values() for edge in around)
    long = {
        edge: count for edge, count in times.items() if gmsh.model.occ.getMass(1, edge) > _POINT
    }
    if free := sum(count < 2 for count in long.values()):
        raise ValueError(
            f"its {len(faces)} faces leave {free} edges open, where gaps of up to {_GAP:g} m are "
            f"sewn, and enclose no solid; {_WAY_OUT}"
        )
    if many := sum(count > 2 for count in long.values()):
        raise ValueError(
            f"{many} edges belong to more than two faces, as where two solids touch, and the file "
            f"does not say which faces are those of one solid; {_WAY_OUT}"
        )
    users: dict[int, list[int]] = {}
    for face, around in edges.items():
        for edge in around:
            users.setdefault(edge, []).append(face)
    shells, left = [], set(faces)
    while left:
        front, shell = {min(left)}, set()
        while front:
            shell |= front
            front = {face for one in front for edge in edges[one] for face in users[edge]} - shell
        shells.append(sorted(shell))
        left -= shell
    return shells


def _check_apart(gmsh) -> None:
    """Raise ValueError for solids without volume, and for a solid inside another: the surface of a
    cavity looks the same."""
    solids = gmsh.model.getEntities(3)
    if any(gmsh.model.occ.getMass(*solid) <= 0.0 for solid in solids):
        raise ValueError(f"its faces enclose no volume; {_WAY_OUT}")
    for solid in solids:
        corners = gmsh.model.getBoundary([solid], combined=False, recursive=True)
        for other in solids:
            if other == solid or not corners:
                continue
            place = gmsh.model.getValue(0, corners[0][1], [])
            if gmsh.model.isInside(3, other[1], place):
                raise ValueError(
                    "one of its closed surfaces lies inside another, and the file does not say "
                    f"whether it bounds a cavity; {_WAY_OUT}"
                )
