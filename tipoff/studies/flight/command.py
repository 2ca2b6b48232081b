"""``tipoff flight``: the payload after its exit."""

from functools import partial
from typing import Annotated

import typer

from tipoff.studies.commands.options import Conditions, SeedOfFile, Surrogate, Vary
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output, quantity


@scene_command()
def flight(
    request: Request,
    condition: Conditions = None,
    range_: Annotated[
        str | None,
        typer.Option(
            "--range",
            metavar="LENGTH",
            help='Distance of the target along the launch axis, "500 m"; default: that of the scene.',
        ),
    ] = None,
    altitude: Annotated[
        str | None, typer.Option(metavar="LENGTH", help='Altitude of the orbit, "500 km".')
    ] = None,
    duration: Annotated[
        str | None, typer.Option(metavar="TIME", help='Duration of the flight, "2 hour".')
    ] = None,
    vary: Vary = "paper",
    cases: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Number of cases; default: that of the file."),
    ] = None,
    seed: SeedOfFile = None,
    model: Surrogate = None,
) -> Output:
    """Compute the flight of the payload in orbit: miss distance, pointing error, coning, and
    clearance to the platform.

    Runs every condition and many cases with random errors; writes flight.json, flight.nc and
    figures. The scene defines the orbit and the target:

      \\[flight]
      altitude = "500 km"
      range = "100 m"

    azimuth, elevation and roll turn the launch axis out of the flight direction. Options replace
    values of the table:

      tipoff flight --range "1 km" --cases 10000
      tipoff flight --scene my_launcher.toml --altitude "600 km" --range "200 m" --set flight.elevation="90 deg"
    """
    from tipoff.scenes.faults import together
    from tipoff.studies.flight import page, stage

    given = {"range": range_, "altitude": altitude, "duration": duration}
    kinds = {
        "range": ("m", "500 m"),
        "altitude": ("m", "500 km"),
        "duration": ("s", "2 hour"),
    }
    together(*(partial(_require, name, given[name], *kind) for name, kind in kinds.items()))
    table = [f"flight.{key}={value}" for key, value in given.items() if value is not None]
    study = request.study(condition, table)
    options = stage.Options(vary, cases, seed, model)
    return Output(stage.run(study, options), page.terminal, request.out)


def _require(name: str, text: str | None, unit: str, example: str) -> None:
    """Raise SceneError where the option ``name`` has no quantity in ``unit``; "absent" drops the
    key."""
    if text != "absent":
        quantity(f"--{name}", text, unit, example)
