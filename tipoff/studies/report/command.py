"""``tipoff report``."""

from typing import Annotated

import typer

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def report(
    request: Request,
    every: Annotated[
        bool,
        typer.Option(
            "--every",
            help="First run every study that has no current result (an hour). If the scene does not "
            "allow a study, the page gives the reason.",
        ),
    ] = False,
    limit: Annotated[
        list[str] | None,
        typer.Option(
            "--limit",
            metavar="[AXIS=]RATE",
            help='Limit of a rate, "x=2 deg/s", or of the total rate, "5 deg/s". The page compares '
            "the rates with it; studies that --every makes have it too. Repeatable.",
        ),
    ] = None,
) -> Output:
    """Show all results on one self-contained page; writes report.html and figures/.

    First come velocity and rates of the scene itself, with their 95 % range under the random errors
    that the scene states (studies.errors). Makes mesh, highfi, lowfi, calibrate, compare, cost
    and ablation where they are out of date; the page is written again as they arrive, and
    a chaotic condition gets 8 neighbours (--every: all). The page shows every other study that has
    a result; --every makes them all.
    """
    from tipoff.studies.populations import exceedance
    from tipoff.studies.report import stage

    def shown(found: dict) -> list[str]:
        return [*found["answer"], *filter(None, [found["verdict"]])]

    limits = exceedance.limits(limit or [])
    return Output(stage.run(request.study(), every, limits), shown, request.out)
