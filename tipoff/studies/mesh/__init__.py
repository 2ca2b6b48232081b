"""The mesh of the rails for the reference."""

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output
from tipoff.studies.question import Contents, Entry, Result, Section


@scene_command(without=["workers"])
def mesh(request: Request) -> Output:
    """Mesh the rails for the reference; writes mesh.json (size, surfaces, quality) and mesh.vtu.

    rail.inp is the first rail for CalculiX and Abaqus, with a load and the answers of tipoff in its
    head: ccx rail.
    """
    from tipoff.studies.mesh import page, stage

    return Output.of(stage.run(request.study()), page.terminal, request.out)


def _load() -> Contents:
    from tipoff.studies.mesh import page, stage

    return Contents((Result("mesh", stage.run),), (Section("mesh", "Mesh", page.draw, "Mesh"),))


ENTRY = Entry((mesh,), _load)
