"""Announce the cost of many runs of the reference before they begin."""

from collections.abc import Sequence

from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study
from tipoff.workspace.words import counted


def announce(study: Study, runs: Sequence[Run]) -> None:
    """Print the number of missing ``runs`` of the reference, and the time and memory that they
    take."""
    from tipoff import highfi  # slow to load
    from tipoff.highfi.rail import memory_estimate, step_cost
    from tipoff.highfi.statics import assembly

    for size in dict.fromkeys(run.numerics.element_size for run in runs):
        wanted = [run for run in runs if run.numerics.element_size == size]
        missing = [run for run in wanted if not study.store.path(run).is_file()]
        if not missing:
            continue
        mesh = highfi.prepare(missing[0].scene, missing[0].numerics)
        elements, nodes = mesh.cells.shape
        shapes = len(assembly.shape_classes(mesh)[1])
        memory = memory_estimate.of_mesh(elements, nodes, shapes)
        _, seconds = step_cost.run_time(mesh, missing[0].scene)
        verb = "is" if len(missing) == 1 else "are"
        say(
            f"  {len(missing)} of {counted(len(wanted), 'run')} of the reference on elements of "
            f"{1e3 * size:g} mm {verb} to be made: {elements:,} elements, about "
            f"{step_cost.in_words(len(missing) * seconds)} on one core, "
            f"{memory_estimate.in_words(memory)} for each of {study.settings.workers} parallel "
            "runs; an interrupted study continues from the finished runs"
        )
