"""``tipoff ablation``."""

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def ablation(request: Request) -> Output:
    """Run without one effect at a time: time, rates, compiled effects; writes ablation.json."""
    from tipoff.studies.ablation import page, stage

    return Output(stage.run(request.study()), page.terminal, request.out)
