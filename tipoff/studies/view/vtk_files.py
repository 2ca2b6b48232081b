"""Frames as a time series for ParaView: a .vtu of the rails and one of the bodies a frame, and a
.pvd that lists them by time.

Positions are in platform axes (``studies.view.frames``) and undeformed, so "Warp By Vector" shows the
deformation at any scale. Fields have single precision, which halves the files. Every file is written
atomically, and the list is written last, so all files in the list are complete.
"""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from tipoff.files import replacing
from tipoff.highfi.mesh.cells import kind
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.studies.view.frames import Frame

DISPLACEMENT, VON_MISES, WORST = (
    "displacement (m)",
    "von Mises stress (Pa)",
    "von Mises stress, worst of element (Pa)",
)
PRESSURE, PAD = "contact pressure (Pa)", "pad (0: payload)"
COLLECTION = "run.pvd"


def write_frame(
    folder: Path, index: int, frame: Frame, mesh: RailMesh, boxes: np.ndarray, pads: np.ndarray
) -> list[Path]:
    """Write rails and bodies of one frame; ``boxes`` (b,8,3) m in payload axes, ``pads`` (b,) their
    pad numbers."""
    import meshio

    rails = meshio.Mesh(
        mesh.points,
        [(kind(mesh.cells).cell, mesh.cells)],
        point_data={
            DISPLACEMENT: _single(frame.displacement),
            VON_MISES: _single(frame.von_mises),
            PRESSURE: _single(frame.pressure),
        },
        cell_data={WORST: [_single(frame.worst)]},
    )
    places = (boxes @ frame.turn.T + frame.centre).reshape(-1, 3)
    bodies = meshio.Mesh(
        places,
        [("hexahedron", np.arange(len(places)).reshape(-1, 8))],
        cell_data={PAD: [pads.astype(np.int32)]},
    )
    paths = [folder / f"{name}-{index:04d}.vtu" for name in ("rails", "bodies")]
    for path, part in zip(paths, (rails, bodies)):
        with replacing(path) as temporary:
            part.write(temporary, file_format="vtu")
    return paths


def write_collection(folder: Path, times: list[float], frames: list[list[Path]]) -> Path:
    """Write the list of all files by time (s); part 0 are the rails, part 1 the bodies."""
    root = ElementTree.Element(
        "VTKFile", type="Collection", version="0.1", byte_order="LittleEndian"
    )
    inside = ElementTree.SubElement(root, "Collection")
    for time, paths in zip(times, frames):
        for part, path in enumerate(paths):
            ElementTree.SubElement(
                inside, "DataSet", timestep=f"{time:.9g}", group="", part=str(part), file=path.name
            )
    ElementTree.indent(root)
    path = folder / COLLECTION
    with replacing(path) as temporary:
        ElementTree.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)
    return path


def discard_others(folder: Path, keep: list[Path]) -> None:
    """Remove frames of an earlier series that are not part of this one."""
    for path in folder.glob("*-[0-9][0-9][0-9][0-9].vtu"):
        if path not in keep:
            path.unlink()


def _single(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float32)
