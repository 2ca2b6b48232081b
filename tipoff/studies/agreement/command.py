"""``tipoff compare``."""

from tipoff.studies.commands.options import Neighbours
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def compare(request: Request, neighbours: Neighbours = None) -> Output:
    """Compare the surrogates with the reference on fitted and held-out conditions: agreement, floor,
    speed-up; writes agreement.json."""
    from tipoff.studies.agreement import page, stage

    options = None if neighbours is None else stage.Options(neighbours)
    return Output(stage.run(request.study(), options), page.terminal, request.out)
