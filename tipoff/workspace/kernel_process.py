"""Kernels of compliant contact, compiled in a separate process while this one solves the statics of
the rails. Both take many seconds, and one needs no result of the other: the kernels do not depend on the
values of a compliance.

The process gets the scene as JSON on its standard input and leaves its kernels in the cache. If it
fails, the run compiles them.
"""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import numpy as np

from tipoff.mechanics.laws.thermal import FIELDS
from tipoff.mechanics.model import half_sizes
from tipoff.mechanics.rail_compliance import DEGREE, RailCompliance, patterns
from tipoff.scenes import parse, scene_model
from tipoff.scenes.rail_compliance import digest
from tipoff.scenes.scene import Scene
from tipoff.workspace import kernel_marks, machine
from tipoff.workspace.compiling import warm_up
from tipoff.workspace.run import Run


@contextmanager
def compiled_beside(scene: Scene, workers: int, degree: int = DEGREE) -> Iterator[None]:
    """Compile the kernels of compliant contact for ``scene``, with patterns of this ``degree``, in a
    process during the block, and wait for it at the end. An exception in the block, such as Ctrl-C, ends the process.

    Does nothing if the kernels are there, with one of ``workers``, and on one core.
    """
    if min(workers, machine.cores()) < 2:
        yield
        return
    run = request(scene, degree)
    if kernel_marks.are_there(run):
        yield
        return
    kernel_marks.announce(run)
    process = subprocess.Popen(
        [sys.executable, "-c", f"from {__name__} import main; main()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )
    assert process.stdin is not None
    try:
        with suppress(BrokenPipeError), process.stdin as order:  # it may have ended
            json.dump([run.scene.resolved(), degree], order)
        yield
        if process.wait() == 0:
            kernel_marks.remember(run)
    finally:
        process.kill()
        process.wait()


def main() -> None:
    """Compile the kernels of the scene and the degree on standard input."""
    scene, degree = json.load(sys.stdin)
    warm_up(request(parse(scene, bare_numbers_are_si=True), degree))


def request(scene: Scene, degree: int = DEGREE) -> Run:
    """A run of ``scene`` with the kernels of any of its runs on compliant contact. Its walls do not
    yield."""
    from tipoff import lowfi

    if scene.rail.mount_stiffness is not None:
        scene = scene.replace({"rail.mount_stiffness.factor": 1.0})
    faces = scene_model.built(scene).nominal
    count, size, first = faces.axis.size, patterns.count(degree), patterns.DRAGGED
    still = RailCompliance(
        travel=np.array([0.0, 1.0]),
        flexibility=np.zeros((2, count, count, size, size)),
        rail=np.zeros(count, dtype=np.int64),
        half=half_sizes(faces),
        frequency=np.zeros((1, 0)),
        shape=np.zeros((2, count, size, 0)),
        made_for=digest(scene),
        warm=None if scene.thermal is None else np.zeros((FIELDS, 2, count, size)),
        dragged=np.zeros((2, count, count, first, first)),
    )
    return Run("lowfi", scene.name, scene, lowfi.Numerics(), compliance=still)
