"""A mesh file read by its format, which the end of its name gives."""

import contextlib
import io
from pathlib import Path

import meshio

from tipoff.files import open_input
from tipoff.highfi.mesh.files import abaqus, gmsh_msh, nastran
from tipoff.highfi.mesh.files.tables import Unreadable
from tipoff.highfi.mesh.memory_limit import limited

_OWN = {
    ".msh": ("gmsh", gmsh_msh.read),
    ".inp": ("Abaqus", abaqus.read),
    ".bdf": ("Nastran", nastran.read),
    ".nas": ("Nastran", nastran.read),
    ".fem": ("Nastran", nastran.read),
    ".dat": ("Nastran", nastran.read),
}
SUFFIXES = (*_OWN, ".vtu")
# bytes of memory that reading a mesh takes at most: numbers as text in lists of Python, per byte of
# the file, and what any file takes
_PER_BYTE, _BESIDE = 100, 2**29


def opened(path: Path) -> meshio.Mesh:
    """The mesh in a file. Raises Unreadable, also where the reader fails in a way of its own."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise Unreadable(
            f"a mesh file ends in one of {', '.join(SUFFIXES)}; other formats have no names for "
            "groups of faces, or files beside them"
        )
    name, reader = _OWN.get(suffix, ("VTU", None))
    output = io.StringIO()
    try:
        # meshio prints what is wrong with a file, and then asks the whole program to exit.
        with (
            contextlib.redirect_stdout(output),
            contextlib.redirect_stderr(output),
            limited(_PER_BYTE * path.stat().st_size + _BESIDE),
        ):
            if reader is None:
                return meshio.read(path, "vtu")
            with open_input(path) as stream:
                content = stream.read()
            return reader(content)
    except Unreadable as fault:
        raise Unreadable(f"as a file of {name}: {fault}") from fault
    # what no check foresaw, in this reader or in that of meshio
    except (Exception, SystemExit) as fault:
        why = " ".join(output.getvalue().split()) or f"{type(fault).__name__}: {fault}"
        raise Unreadable(f"the reader of {name} files fails on it ({why})") from fault
