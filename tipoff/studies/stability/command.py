"""``tipoff stability``."""

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def stability(request: Request) -> Output:
    """Run hard cases, each with a simpler method that fails on it; writes stability.json."""
    from tipoff.studies.stability import page, stage

    return Output(stage.run(request.study()), page.terminal, request.out)
