"""``tipoff cost``."""

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def cost(request: Request) -> Output:
    """Measure error over wall time, and growth of time with elements, pads and effects; writes
    cost.json and cost_study.json."""
    from tipoff.studies.cost import page, stage

    return Output(stage.run(request.study()), page.terminal, request.out)
