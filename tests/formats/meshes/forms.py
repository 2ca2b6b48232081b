"""The small rail of ``seeds`` in all formats that are read: those of ``seeds``, LS-DYNA, universal files, MED
and VTK."""

from pathlib import Path

import meshio
import numpy as np

from tests.formats.meshes import lsdyna_text, seeds
from tipoff.meshes import msh

OWN = {
    "LS-DYNA standard": ".k",
    "LS-DYNA long": ".key",
    "LS-DYNA free": ".dyn",
    "LS-DYNA nodes": ".k",
    "universal": ".unv",
    "universal nodes": ".unv",
    "MED": ".med",
    "VTK": ".vtu",
    "VTK text": ".vtu",
    "VTK legacy": ".vtk",
}
ALL = seeds.FORMS | OWN
BINARY = ("gmsh 2.2 binary", "gmsh 4.1 binary", "MED", "VTK legacy")


def write(form: str, path: Path) -> Path:
    """The plate as a file without suffix ``path`` and with that of the format."""
    if form in seeds.FORMS:
        return seeds.write(form, path)
    file = path.with_suffix(OWN[form])
    if form == "LS-DYNA nodes":
        file.write_text(lsdyna_text.text(surfaces="nodes"), encoding="utf-8")
    elif form.startswith("LS-DYNA"):
        file.write_text(lsdyna_text.text(form.split()[1]), encoding="utf-8")
    elif form.startswith("universal"):
        file.write_text(universal(shells="nodes" not in form), encoding="utf-8")
    elif form == "MED":
        _med(file)
    elif form == "VTK legacy":
        meshio.vtk.write(file, tagged())
    else:
        meshio.vtu.write(file, tagged(), binary="text" not in form)
    return file


def universal(shells: bool = True, code: str = "2467") -> str:
    """The plate as text, in the columns of the description of the datasets."""
    points, cells, surfaces = seeds.rail()
    lines = [
        "    -1",
        "   164",
        "         1  SI: Meters (newton)         2",
        "    -1",
        "    -1",
        "  2411",
    ]
    for number, place in enumerate(points, 1):
        lines.append(f"{number:10}{1:10}{1:10}{11:10}")
        lines.append("".join(f"{x:25.16E}" for x in place).replace("E", "D"))
    lines += ["    -1", "    -1", "  2412", f"{900:10}{21:10}{1:10}{1:10}{7:10}{2:10}"]
    lines += [f"{0:10}{1:10}{1:10}", f"{1:10}{2:10}"]  # a beam has a line more
    label, groups = 0, []
    for descriptor, found in ((115, cells), *((94, facets) for facets in surfaces.values())):
        if descriptor == 94 and not shells:
            continue
        first = label + 1
        for row in found + 1:
            label += 1
            lines.append("".join(f"{n:10}" for n in (label, descriptor, 2, 1, 7, len(row))))
            lines.append("".join(f"{n:10}" for n in row))
        groups.append([(8, each) for each in range(first, label + 1)])
    lines += ["    -1", "    -1", f"  {code}"]
    if not shells:
        groups = [[], *([(7, int(n) + 1) for n in np.unique(f)] for f in surfaces.values())]
    for number, (name, members) in enumerate(zip(surfaces, groups[1:]), 1):
        lines.append("".join(f"{n:10}" for n in (number, 0, 0, 0, 0, 0, 0, len(members))))
        lines.append(name)
        width = 4 if code in ("2467", "2477", "2452", "2435") else 2
        flat = [value for kind, tag in members for value in (kind, tag, 0, 0)[:width]]
        lines += ["".join(f"{n:10}" for n in flat[at : at + 8]) for at in range(0, len(flat), 8)]
    return "\n".join([*lines, "    -1", ""])


def tagged(kind: str = "float") -> meshio.Mesh:
    """The plate with a number for each surface in the array ``part`` and marks in ``mount``."""
    mesh = msh.tagged(*seeds.rail())
    tags = mesh.cell_data["gmsh:physical"]
    points = np.zeros(len(mesh.points))
    points[np.unique(seeds.rail().surfaces["contact"])] = 1.0
    return meshio.Mesh(
        mesh.points,
        mesh.cells,
        cell_data={"part": tags, "Mount": [(tag == 1).astype(kind) for tag in tags]},
        point_data={"contact": points, "temperature": 300.0 + points, "speed": mesh.points},
    )


def _med(path: Path) -> None:
    """meshio does not turn the faces of solids, as gmsh and Salome do."""
    mesh = msh.tagged(*seeds.rail())
    families = [-tag for tag in mesh.cell_data["gmsh:physical"]]
    own = meshio.Mesh(mesh.points, [mesh.cells[0]], cell_data={"cell_tags": [families[0]]})
    quads = np.concatenate([block.data for block in mesh.cells[1:]])
    own.cells.append(meshio.CellBlock("quad", quads))
    own.cell_data["cell_tags"].append(np.concatenate(families[1:]))
    own.cell_tags = {-1: ["mount"], -2: ["Contact", "end"], -3: ["rail"]}
    own.point_tags = {}
    meshio.med.write(path, own)
