"""``tipoff calibrate``."""

from collections.abc import Callable
from typing import Annotated

import typer

from tipoff.studies.commands.options import (
    SettledFrom,
    SurrogateName,
    condition_names,
    of_files,
)
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output, quantity
from tipoff.studies.commands.running import files as written


@scene_command()
def calibrate(
    request: Request,
    reference: Annotated[
        list[str] | None,
        typer.Option(
            "--reference",
            metavar="[NAME=]FILE",
            help="File with curves of condition NAME, used instead of the reference; repeatable.",
        ),
    ] = None,
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            autocompletion=condition_names,
            help="Condition of a FILE that is given without NAME; default: the scene itself.",
        ),
    ] = None,
    columns: Annotated[list[str] | None, of_files("--columns")] = None,
    units: Annotated[list[str] | None, of_files("--units")] = None,
    body: Annotated[list[str] | None, of_files("--body")] = None,
    axes: Annotated[list[str] | None, of_files("--axes")] = None,
    ignition: Annotated[list[str] | None, of_files("--ignition")] = None,
    settled_from: SettledFrom = None,
    model: Annotated[
        SurrogateName | None,
        typer.Option(
            "--model",
            help="Calibrate only this model. Default: both; with --reference: springs; with --fit: "
            "compliant.",
        ),
    ] = None,
    fit: Annotated[
        list[str] | None,
        typer.Option(
            "--fit",
            metavar="KEY",
            help="Parameter of compliant contact to fit, such as contact.clearance. Repeatable, or "
            "several with commas. all: every parameter that the curves determine.",
        ),
    ] = None,
) -> Output:
    """Compute the rail compliance, and fit springs to the reference; writes compliance.json,
    calibration.json and calibration.toml.

    The rail compliance comes from statics, without a run of the reference. The constants of springs
    are fitted to curves of the reference. --model compliant or --model springs does only one of both.

    Curves of another code or of a test can replace the reference. Then the results are in curves/:

      tipoff calibrate --reference phi15=test15.csv --reference phi60=test60.csv --settled-from "44 ms"

    By default these curves determine the constants of springs. With --model compliant they determine
    interface stiffness, mount stiffness, clearance and friction, as far as they contain the
    information. --fit names the parameters to fit, also errors of mounting. Without --reference it
    fits them to the reference:

      tipoff calibrate --fit contact.clearance,friction.dynamic --fit thrust_offset.misalignment.y

    Errors of mounting are changes: one amount, added to the value of each condition. They are
    initial.position.y and .z, initial.attitude.x, .y and .z, thrust_offset.misalignment.y and .z,
    thrust_offset.eccentricity.y and .z, thrust.arm, mass_offset.eccentricity.y and .z,
    payload.inertia.xy, .xz and .yz. contact.clearance_y and .clearance_z are clearances along one
    axis. tipoff run and tipoff ensemble read calibration.toml with --calibration.

    A file is one of: {formats of curves}. It has time (from ignition, at any instants), velocity_x
    (inertial, along the rail), rate_x, rate_y and rate_z (inertial, in payload body axes). Units are
    in the header, rate_x \\[deg/s], in the line below it, or in --units. Other columns are ignored.

      tipoff calibrate --reference phi15=rbdout --body 7 --units "time=ms, length=mm"
      tipoff calibrate --reference phi15=adams.tab --columns "time=Time, velocity_x=VX, rate_x=WX,
    rate_y=WY, rate_z=WZ" --units "time=s, velocity_x=mm/s, rate=deg/s"
    """
    from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
    from tipoff.studies.calibration import compliance_page, page, stage

    start = quantity("--settled-from", settled_from, "s", "44 ms")
    files = stage.named(reference or [], condition, start)
    layouts = stage.laid_out(files, columns, units, body, axes, ignition)
    study = request.study()
    chosen = None if fit is None else [name.strip() for one in fit for name in one.split(",")]
    default = SPRINGS if chosen is None else COMPLIANT
    if files:
        found = stage.from_files(study, files, start, model or default, chosen, layouts)
    elif chosen is not None:
        found = stage.on_reference(study, model or default, chosen)
    else:
        both = stage.of_models(study, model)
        documents = {name: made.document for name, made in both.items()}
        drawn: dict[str, Callable] = {"compliance": compliance_page.draw, "springs": page.draw}
        parts = [
            part
            for name, made in both.items()
            for part in (*drawn[name](made.result), "\n".join(written(made.document, request.out)))
        ]
        return Output({"scene": study.scene.name, **documents}, lambda _: parts)
    return Output.of(found, page.draw, request.out)
