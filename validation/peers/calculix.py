"""Decks for CalculiX (``ccx``), its runs, and its result tables.

A deck is written from a mesh of the project: the nodes and elements, as 8-node hexahedra with
incompatible modes (C3D8I), or as 20-node ones of reduced integration (C3D20R) whose middle nodes are the
middles of the edges. Axes and units are those of the scene, SI. CalculiX runs as a separate program;
nothing is linked.
"""

import os
import re
import resource
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from validation.peers.case import PeerMissing, Unfinished, require_count, require_finished

LINEAR, QUADRATIC = "C3D8I", "C3D20R"
# Corners of the edges in the order of the middle nodes of C3D20.
_EDGES = np.array(
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
)
# Corners of the faces S1 to S6.
_FACES = np.array(
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
)
_PER_LINE = 16
_LAYER = 1e-5  # m, thickness of the layer that stands for a joint
_WEAK = 1e-3  # of its stiffness across: along the layer
_TIMEOUT = 3600.0  # s
_CODE, _DONE = "CalculiX", "Job finished"


class Solid(NamedTuple):
    """A mesh as CalculiX takes it; arrays count from 0, decks from 1."""

    kind: str  # of its elements
    points: np.ndarray  # (n,3) m
    cells: np.ndarray  # (e,8) or (e,20)


class Answer(NamedTuple):
    """The content of the ``.dat`` file of a run, and its processor time (s)."""

    text: str
    cpu_s: float

    def table(self, title: str, rows: int, time: float | None = None) -> np.ndarray:
        """The numbers below the last line that starts with ``title``. Raises Unfinished unless they
        are as many ``rows`` as asked, are finite, and belong to the ``time`` (s) that was asked."""
        lines = self.text.splitlines()
        places = [place for place, line in enumerate(lines) if line.strip().startswith(title)]
        if not places:
            raise Unfinished(f"{_CODE} printed no {title}")
        found = _numbers(lines[places[-1] + 1 :])
        require_count(_CODE, f"rows of {title}", len(found), rows)
        if time is not None:
            stated = re.search(r"time\s+([-+.\dE]+)\s*$", lines[places[-1]])
            reached = float(stated[1]) if stated else np.nan
            require_finished(_CODE, reached, time)
        require_finished(_CODE, 0.0, 0.0, found)
        return found


def version() -> str:
    """Version of the installed ``ccx``. Raises PeerMissing."""
    said = subprocess.run([_program(), "-v"], capture_output=True, text=True).stdout
    found = re.search(r"[Vv]ersion\s+([\d.]+\w*)", said)
    return found[1] if found else "unknown"


def _program() -> str:
    program = shutil.which("ccx")
    if program is None:
        raise PeerMissing(
            "ccx is not on the path; on Debian, as root: apt-get install calculix-ccx"
        )
    return program


def solid(mesh: RailMesh, kind: str) -> Solid:
    """The hexahedra of ``mesh`` as elements of a ``kind``; its own nodes keep their numbers."""
    if kind == LINEAR:
        return Solid(kind, mesh.points, mesh.cells)
    edges = np.sort(mesh.cells[:, _EDGES].reshape(-1, 2), axis=1)
    unique, number = np.unique(edges, axis=0, return_inverse=True)
    middles = mesh.points[unique].mean(axis=1)
    extra = len(mesh.points) + number.reshape(-1, len(_EDGES))
    return Solid(kind, np.vstack([mesh.points, middles]), np.hstack([mesh.cells, extra]))


def sides(of: Solid, facets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Element, number of its face from 0, and nodes (m,4) or (m,8) of each of ``facets`` (m,4)."""
    corners = np.sort(of.cells[:, _FACES], axis=2).reshape(-1, 4)
    place = {tuple(key): index for index, key in enumerate(corners.tolist())}
    found = np.array([place[tuple(sorted(facet))] for facet in facets.tolist()])
    element, face = found // len(_FACES), found % len(_FACES)
    nodes = of.cells[element[:, None], _FACES[face]]
    if of.kind == QUADRATIC:
        middle = {tuple(sorted(edge)): 8 + index for index, edge in enumerate(_EDGES.tolist())}
        local = {}
        for number, corner in enumerate(_FACES.tolist()):
            edges = zip(corner, corner[1:] + corner[:1])
            local[number] = [middle[tuple(sorted(edge))] for edge in edges]
        nodes = np.hstack([nodes, of.cells[element[:, None], [local[number] for number in face]]])
    return element, face, nodes


def shares(nodes: np.ndarray) -> np.ndarray:
    """Shares of the nodes of a rectangular face in the force of a uniform pressure: of four nodes,
    or of eight (corners -1/12, middles 1/3)."""
    return np.full(4, 0.25) if nodes.shape[1] == 4 else np.repeat([-1.0 / 12.0, 1.0 / 3.0], 4)


def head(
    of: Solid,
    material: tuple[float, float, float],
    extra: str = "",
    first: tuple[int, int] = (0, 0),
    name: str = "SOLID",
) -> str:
    """Nodes (set N<name>), elements (set <name>) and the ``material`` (density, Young's modulus,
    Poisson's ratio) of a solid, with ``extra`` cards of it; ``first`` are the numbers of nodes and
    elements before it."""
    density, modulus, ratio = material
    points = enumerate(of.points, first[0] + 1)
    return "\n".join(
        [
            f"*NODE, NSET=N{name}",
            *(f"{i},{x:.13g},{y:.13g},{z:.13g}" for i, (x, y, z) in points),
            f"*ELEMENT, TYPE={of.kind}, ELSET={name}",
            *(_element(i, nodes + 1 + first[0]) for i, nodes in enumerate(of.cells, first[1] + 1)),
            f"*MATERIAL, NAME=M{name}",
            f"*ELASTIC\n{modulus:.13g},{ratio:.13g}",
            f"*DENSITY\n{density:.13g}",
            f"{extra}*SOLID SECTION, ELSET={name}, MATERIAL=M{name}\n",
        ]
    )


def _element(number: int, nodes: np.ndarray) -> str:
    return ",\n".join(_lines([number, *nodes.tolist()]))


def _lines(numbers: list[int]) -> list[str]:
    """At most 16 numbers a line, as a deck has them."""
    starts = range(0, len(numbers), _PER_LINE)
    return [",".join(map(str, numbers[start : start + _PER_LINE])) for start in starts]


def members(kind: str, name: str, numbers: np.ndarray) -> str:
    """A set of nodes (``kind`` NSET) or of elements (ELSET); ``numbers`` count from 0."""
    card = {"NSET": "*NSET, NSET", "ELSET": "*ELSET, ELSET"}[kind]
    return "\n".join([f"{card}={name}", *_lines((np.unique(numbers) + 1).tolist()), ""])


def held(of: Solid, facets: np.ndarray) -> str:
    """The set HELD of all nodes of ``facets`` (m,4), fixed in all directions."""
    return members("NSET", "HELD", sides(of, facets)[2]) + "*BOUNDARY\nHELD,1,3\n"


def joined(of: Solid, facets: np.ndarray, joint: MountStiffness) -> str:
    """A thin elastic layer on ``facets`` (m,4), whose other side is fixed: its stiffness over its
    thickness is that of the ``joint``. Facets must be normal to y or z."""
    _, _, nodes = sides(of, facets)
    count, last = len(of.points), len(of.cells)
    deck = ""
    for axis in (1, 2):
        flat = np.ptp(of.points[nodes][..., axis], axis=1) < 1e-9
        under = nodes[flat]
        own, place = np.unique(under, return_inverse=True)
        outwards = _LAYER * np.sign(of.points[own, axis]) * np.eye(3)[axis][:, None]
        away = of.points[own] + outwards.T
        place = place.reshape(under.shape) + count
        cells = [place[:, :4], under[:, :4]]
        points = away
        if of.kind == QUADRATIC:
            points = np.vstack([away, 0.5 * (away + of.points[own])])
            cells += [place[:, 4:], under[:, 4:], place[:, :4] + len(own)]
        name = f"JOINT{'XYZ'[axis]}"
        kind = {LINEAR: "C3D8", QUADRATIC: "C3D20"}[of.kind]
        deck += "\n".join(
            [
                "*NODE",
                *(
                    f"{i},{x:.13g},{y:.13g},{z:.13g}"
                    for i, (x, y, z) in enumerate(points, count + 1)
                ),
                f"*ELEMENT, TYPE={kind}, ELSET={name}",
                *(_element(i, row + 1) for i, row in enumerate(np.hstack(cells), last + 1)),
                f"*MATERIAL, NAME=M{name}",
                f"*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{_layer(axis, joint)}",
                "*DENSITY\n1e-3",
                f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}\n",
            ]
        )
        deck += members("NSET", f"AWAY{name}", count + np.arange(len(own)))
        deck += f"*BOUNDARY\nAWAY{name},1,3\n"
        count, last = count + len(points), last + len(under)
    return deck


def _layer(axis: int, joint: MountStiffness) -> str:
    """Engineering constants (Pa) of a layer whose normal is along ``axis``."""
    young = [_WEAK * joint.normal] * 3
    young[axis] = joint.normal
    pairs = ((0, 1), (0, 2), (1, 2))
    shear = [joint.shear if axis in pair else _WEAK * joint.shear for pair in pairs]
    first = [*young, 0.0, 0.0, 0.0, *shear[:2]]
    lines = [",".join(f"{_LAYER * value:.13g}" for value in row) for row in (first, shear[2:])]
    return "\n".join(lines)


def surface(name: str, of: Solid, facets: np.ndarray, first: int) -> str:
    """A surface of element faces; ``first`` elements stand before those of the solid."""
    element, face, _ = sides(of, facets)
    lines = [f"{e + 1 + first},S{f + 1}" for e, f in zip(element, face)]
    return "\n".join([f"*SURFACE, NAME={name}, TYPE=ELEMENT", *lines, ""])


def pressure(of: Solid, facets: np.ndarray, value: float) -> str:
    """A ``value`` (Pa) on ``facets``."""
    element, face, _ = sides(of, facets)
    lines = [f"{e + 1},P{f + 1},{value:.13g}" for e, f in zip(element, face)]
    return "\n".join(["*DLOAD", *lines, ""])


def run(deck: str) -> Answer:
    """Solve ``deck`` on one thread in a folder of its own. Raises PeerMissing, and Unfinished
    with the last lines of CalculiX if it fails."""
    program = _program()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "job.inp").write_text(deck)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        said = subprocess.run(
            [program, "-i", "job"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=_TIMEOUT,  # which raises an error of its own
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        printed = Path(folder, "job.dat")
        whole = "*ERROR" not in said.stdout and _DONE in said.stdout and printed.is_file()
        if said.returncode or not whole:
            raise Unfinished(f"{_CODE}: exit code {said.returncode}:\n{said.stdout[-2000:]}")
        text = printed.read_text()
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Answer(text, cpu)


def _numbers(lines: list[str]) -> np.ndarray:
    """The first block of rows of numbers, without the heads above it."""
    rows: list[list[float]] = []
    for line in lines:
        try:
            row = [float(word) for word in line.split()]
        except ValueError:
            row = []
        if row:
            rows.append(row)
        elif rows:
            break
    return np.array(rows)
