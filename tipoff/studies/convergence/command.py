"""``tipoff convergence``."""

from tipoff.studies.commands.options import RefinedCondition
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def convergence(request: Request, condition: RefinedCondition = None) -> Output:
    """Estimate the error of the reference from mesh, step, interface stiffness and contact cells;
    takes minutes; writes convergence.json."""
    from tipoff.studies.convergence import page, stage

    return Output(stage.run(request.study(), condition), page.terminal, request.out)
