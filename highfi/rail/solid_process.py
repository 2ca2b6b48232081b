"""Solids from CAD files, meshed in a separate process: a damaged line in a file can stop the
process that reads it, keep it busy without end, or use all its memory.

The process gets a scene and an element size as JSON on its standard input. It writes the mesh, or
its refusal, to a folder.
"""

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import tell
from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.rail import memory_estimate
from tipoff.highfi.rail.solid_mesh import meshed
from tipoff.meshes import msh
from tipoff.meshes.generator import GmshUnavailable
from tipoff.scenes import parse
from tipoff.scenes.rail import GeometryTable
from tipoff.scenes.scene import Scene

CPU_SECONDS = 900  # s; millions of elements take a few minutes
_SAID_AFTER = 5.0  # s; loading the libraries takes a second or two
_REPLY, _ARRAYS = "reply.json", "mesh.npz"


def mesh_of(
    scene: Scene, rail: GeometryTable, element_size: float
) -> tuple[meshio.Mesh, dict[str, float]]:
    """Elements and surfaces of the solid of ``scene``, and the areas (m2) of the solid's own faces in
    the boxes of each surface, as ``solid_mesh.meshed`` makes them.

    Raises SceneError, GmshUnavailable, or MeshError; the last also if the process dies or takes
    more than ``CPU_SECONDS``.
    """
    with tempfile.TemporaryDirectory(prefix="tipoff-") as name:
        folder = Path(name)
        order = {
            "folder": name,
            "scene": scene.resolved(),
            "element_size": element_size,
            "memory": memory_estimate.available(),
            "cpu_seconds": CPU_SECONDS,
        }
        code, errors = _run(json.dumps(order), rail.path())
        if code == -signal.SIGXCPU:
            raise MeshError(
                f"{rail.path()} cannot be used: gmsh has not meshed it after {CPU_SECONDS} s of processor "
                "time, so it is damaged, or the elements are too small"
            )
        if code < 0:
            how = signal.Signals(-code).name
            raise MeshError(
                f"{rail.path()} cannot be used: it is damaged, or too much for gmsh, whose process "
                f"ended with {how}"
            )
        if code:
            raise RuntimeError(f"the process that meshes {rail.path()} failed:\n{errors}")
        reply = json.loads((folder / _REPLY).read_text(encoding="utf-8"))
        if "areas" not in reply:
            raise _refusal(reply)
        with np.load(folder / _ARRAYS, allow_pickle=False) as arrays:
            found = dict(arrays)
    points, elements = found.pop("points"), found.pop("elements")
    surfaces = {surface: found[f"surface {surface}"] for surface in reply["areas"]}
    return msh.tagged(points, elements, surfaces), reply["areas"]


def _run(order: str, file: Path) -> tuple[int, str]:
    """Exit code and errors of the process. A message is printed if it takes long."""
    process = subprocess.Popen(
        [sys.executable, "-c", f"from {__name__} import main; main()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )
    try:
        try:
            _, errors = process.communicate(order, timeout=_SAID_AFTER)
        except subprocess.TimeoutExpired:
            tell(f"  gmsh meshes {file}")
            _, errors = process.communicate()
    except BaseException:  # Ctrl-C
        process.kill()
        raise
    return process.returncode, errors


def _refusal(reply: dict[str, Any]) -> Exception:
    if "faults" in reply:
        return SceneError([Fault(*fault) for fault in reply["faults"]])
    if "mesh_error" in reply:
        return MeshError(reply["mesh_error"])
    return GmshUnavailable(reply["unavailable"])


def main() -> None:
    """Mesh the solid of the request on standard input."""
    order = json.load(sys.stdin)
    if order["memory"] is not None:
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (order["memory"], hard))
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (order["cpu_seconds"], hard))
    folder = Path(order["folder"])
    reply: dict[str, Any]
    try:
        scene = parse(order["scene"], bare_numbers_are_si=True)
        points, elements, surfaces, areas = meshed(scene, order["element_size"], order["memory"])
        arrays: dict[str, Any] = {f"surface {name}": facets for name, facets in surfaces.items()}
        np.savez(folder / _ARRAYS, points=points, elements=elements, **arrays)
        reply = {"areas": areas}
    except SceneError as fault:
        reply = {"faults": fault.faults}
    except MeshError as fault:
        reply = {"mesh_error": str(fault)}
    except GmshUnavailable as fault:
        reply = {"unavailable": str(fault)}
    (folder / _REPLY).write_text(json.dumps(reply), encoding="utf-8")
