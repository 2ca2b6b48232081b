"""``tipoff mesh``."""

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command(without=["workers"])
def mesh(request: Request) -> Output:
    """Mesh the rails for the reference; writes mesh.json (size, surfaces, quality) and mesh.vtu."""
    from tipoff.studies.mesh import page, stage

    return Output(stage.run(request.study()), lambda found: [page.surfaces(found)], request.out)
