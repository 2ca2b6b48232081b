"""``python -m validation recovery``."""

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def recovery(request: Request) -> Output:
    """Test whether calibration finds hidden values: 20 draws with 2 % of noise, and a reference
    with hidden clearance and friction; writes recovery.json."""
    from validation.recovery import page, stage

    return Output(stage.run(request.study()), page.draw, request.out)
