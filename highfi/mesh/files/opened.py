"""Read a mesh file; the end of its name gives its format."""

from functools import partial
from pathlib import Path

import meshio

from tipoff.files import open_input, utf_8
from tipoff.highfi.mesh.files import abaqus, gmsh_msh, lsdyna, med, nastran, universal, vtk
from tipoff.highfi.mesh.files.tables import Unreadable
from tipoff.highfi.mesh.memory_limit import limited
from tipoff.scenes import keyword_files

_READERS = {
    ".msh": ("gmsh", gmsh_msh.read),
    ".inp": ("Abaqus", abaqus.read),
    ".bdf": ("Nastran", nastran.read),
    ".nas": ("Nastran", nastran.read),
    ".fem": ("Nastran", nastran.read),
    ".dat": ("Nastran", nastran.read),
    ".unv": ("I-deas", universal.read),
    ".med": ("Salome", med.read),
    ".vtu": ("VTK", vtk.read_xml),
    ".vtk": ("VTK", vtk.read_legacy),
}
# what to do with the files of other tools
_ADVICE = {
    **dict.fromkeys(
        (".step", ".stp", ".iges", ".igs", ".brep"), "a solid: give it as rail.geometry"
    ),
    **dict.fromkeys((".stl", ".obj", ".ply", ".off"), "a surface, and a rail needs solid elements"),
    **dict.fromkeys((".cae", ".odb"), "a data base of Abaqus: write its input file, .inp"),
    **dict.fromkeys((".hm", ".hmbin"), "a data base of HyperMesh: export .fem, .k or .inp"),
    **dict.fromkeys((".op2", ".xdb", ".h5"), "results of Nastran: give its bulk data, .bdf"),
    **dict.fromkeys((".cdb", ".db", ".mechdat"), "a file of Ansys: export .inp, .k or .bdf"),
    **dict.fromkeys((".hdf", ".fcstd"), "a project: export its mesh as .med, .unv or .inp"),
    **dict.fromkeys((".gz", ".zip", ".xz", ".bz2"), "a packed file: unpack it"),
}
SUFFIXES = (*_READERS, *keyword_files.SUFFIXES)
# bytes: upper bound of the memory to read a mesh. Per byte of the file (lists of Python hold
# numbers as text), and a constant part
_PER_BYTE, _BESIDE = 100, 2**29


def opened(path: Path) -> meshio.Mesh:
    """The mesh in a file. Raises Unreadable, and OSError if it cannot be opened."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        advice = _ADVICE.get(suffix, "let the mesh generator write one of these, with its groups")
        raise Unreadable(f"a mesh file ends in one of {', '.join(SUFFIXES)}; {advice}")
    name, reader = _READERS.get(suffix, ("LS-DYNA", None))
    if reader is None:
        pieces = keyword_files.pieces(path)
        size, made = sum(len(piece.content) for piece in pieces), partial(lsdyna.read, pieces)
    else:
        with open_input(path) as stream:
            content = utf_8(stream.read())
        size, made = len(content), partial(reader, content)
    try:
        with limited(_PER_BYTE * size + _BESIDE):
            return made()
    except Unreadable as fault:
        raise Unreadable(f"as a file of {name}: {fault}") from fault
    except Exception as fault:  # no check foresaw it
        why = f"{type(fault).__name__}: {fault}"
        raise Unreadable(f"the reader of {name} files fails on it ({why})") from fault
