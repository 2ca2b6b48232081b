"""Read a mesh file; the end of its name gives its format."""

from pathlib import Path

import meshio

from tipoff.files import open_input, utf_8
from tipoff.formats.declared import declared, of_suffix
from tipoff.formats.meshes.blocks import MeshFormat, Unreadable
from tipoff.formats.meshes.lsdyna_includes import Piece
from tipoff.formats.meshes.memory_limit import limited

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
# bytes: upper bound of the memory to read a mesh. Per byte of the file (lists of Python hold
# numbers as text), and a constant part
_PER_BYTE, _BESIDE = 100, 2**29


def read_mesh_file(path: Path) -> meshio.Mesh:
    """The mesh in a file. Raises Unreadable, and OSError if it cannot be opened."""
    formats = declared(__package__, MeshFormat)
    found = of_suffix(formats, path)
    if found is None:
        advice = _ADVICE.get(
            path.suffix.lower(), "let the mesh generator write one of these, with its groups"
        )
        suffixes = sorted(suffix for each in formats for suffix in each.suffixes)
        raise Unreadable(f"a mesh file ends in one of {', '.join(suffixes)}; {advice}")
    content: bytes | list[Piece]
    if found.pieces is not None:
        content = pieces = found.pieces(path)
        size = sum(len(piece.content) for piece in pieces)
    else:
        with open_input(path) as stream:
            content = utf_8(stream.read())
        size = len(content)
    try:
        with limited(_PER_BYTE * size + _BESIDE):
            return found.read(content)
    except Unreadable as fault:
        raise Unreadable(f"as a file of {found.name}: {fault}") from fault
    except Exception as fault:  # no check foresaw it
        why = f"{type(fault).__name__}: {fault}"
        raise Unreadable(f"the reader of {found.name} files fails on it ({why})") from fault
