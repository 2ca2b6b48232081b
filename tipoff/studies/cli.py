"""The ``tipoff`` command: one sub-command per stage, all of the same shape.

Exit codes: 0 done; 1 a run failed (its status says why); 2 bad input, every fault listed, nothing
written. Heavy libraries are imported by the command that needs them, so that ``--help`` answers at
once.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.asked import guarded, quantity, study_of
from tipoff.studies.commands.helptext import flow
from tipoff.studies.commands.options import (
    CalibrationFile,
    CheckpointEvery,
    Conditions,
    ElementSize,
    Json,
    Model,
    Modes,
    Out,
    Resume,
    Sampling,
    SceneName,
    Set,
    Surrogate,
    SurrogateName,
    Workers,
)
from tipoff.studies.registry import QUESTIONS

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study

EXAMPLES = """Examples:

  tipoff report                              # the whole page, reference scene
  tipoff run --condition phi35               # one run of the surrogate: milliseconds
  tipoff run --model finite-elements --element-size 8 --set thrust.peak="7 kN"
  tipoff compare --scene tiny --json         # the agreement table as JSON
  tipoff highfi --scene my_launcher.toml     # a scene of your own, begun as a copy of one that tipoff scenes lists
"""

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    help="Which velocity and which angular rates does a payload leave its rail with?\n\n"
    + EXAMPLES,
)


@app.command()
def mesh(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    element_size: ElementSize = None,
    json_: Json = False,
) -> None:
    """Mesh the rails: elements, nodes, named surfaces, quality; writes mesh.json and mesh.vtu."""

    def work() -> dict:
        from tipoff.studies.mesh import stage

        return stage.run(study_of(scene, out, set_, element_size=element_size))

    guarded(work, json_)


@app.command()
def highfi(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Conditions = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    checkpoint_every: CheckpointEvery = None,
    resume: Resume = True,
    json_: Json = False,
) -> None:
    """Run the finite-element reference on every condition; writes highfi.json and a netCDF file
    each."""
    _conditions(
        "highfi",
        json_,
        scene,
        out,
        set_,
        condition,
        element_size,
        workers,
        checkpoint_every,
        resume,
    )


@app.command()
def lowfi(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Conditions = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Run the surrogate, model compliant, on every condition; writes lowfi.json and a netCDF file
    each."""
    _conditions("lowfi", json_, scene, out, set_, condition, None, workers)


def _conditions(fidelity, json_, *asked) -> None:
    """Run every condition of the study that is ``asked`` for, the arguments of ``_study``."""

    def work() -> dict:
        from tipoff.studies.runs import stage as runs

        return runs.run(study_of(*asked), fidelity)

    guarded(work, json_)


def _stage(name: str, summary: str, load: Callable[[], Callable[["Study"], dict]]) -> None:
    """Add the command of a stage that takes the common options only; ``load`` imports it."""

    def command(
        scene: SceneName = "reference",
        out: Out = Path("out"),
        set_: Set = None,
        element_size: ElementSize = None,
        workers: Workers = None,
        json_: Json = False,
    ) -> None:
        def work() -> dict:
            study = study_of(scene, out, set_, element_size=element_size, workers=workers)
            return load()(study)

        guarded(work, json_)

    app.command(name, help=summary)(command)


@app.command()
def calibrate(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    reference: Annotated[
        list[str] | None,
        typer.Option(
            "--reference",
            metavar="[NAME=]FILE",
            help="Curves of condition NAME in a CSV file, in place of finite elements; repeatable.",
        ),
    ] = None,
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            help="Condition of a file without NAME; default: the scene itself.",
        ),
    ] = None,
    settled_from: Annotated[
        str | None,
        typer.Option(
            "--settled-from",
            metavar="TIME",
            help="Start of the 2 ms whose means are the settled values; default: the last 2 ms of "
            "a file.",
        ),
    ] = None,
    model: Annotated[
        SurrogateName | None,
        typer.Option("--model", help="Calibrate this model alone; default: both."),
    ] = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Take the surrogate's contact from the finite elements; writes compliance.json,
    calibration.json and calibration.toml.

    Compliant contact takes the rail's compliance from statics, without a run of the reference;
    springs are fitted to the reference's curves. --model compliant or --model springs does one of
    both.

    Curves of another code or of a test may take the place of the reference; curves/ then receives
    both files:

      tipoff calibrate --reference phi15=test15.csv --reference phi60=test60.csv --settled-from "44 ms"

    A file has the columns time, velocity_x (inertial, along the rail), rate_x, rate_y and rate_z
    (inertial, in payload body axes), from ignition on, at any instants, with units in the header,
    rate_x \\[deg/s], or in the second line. Other columns are ignored.
    """

    def work() -> dict:
        from tipoff.scenes.faults import Fault, SceneError
        from tipoff.studies.calibration import stage

        start = quantity("--settled-from", settled_from, "s")
        files = stage.named(reference or [], condition, start)
        study = study_of(scene, out, set_, element_size=element_size, workers=workers)
        if files and model is SurrogateName.compliant:
            raise SceneError(
                [
                    Fault(
                        "--reference",
                        "option",
                        "given",
                        "none with --model compliant: curves are for springs",
                    )
                ]
            )
        return (
            stage.from_files(study, files, start)
            if files
            else stage.of_models(study, model and model.value)
        )

    found = guarded(work, json_)
    if not json_:
        from tipoff.studies.calibration import stage

        print("\n".join(stage.lines(found, Path(out) / found["scene"])))


def _compare() -> Callable[["Study"], dict]:
    from tipoff.studies.agreement import stage

    return stage.run


def _cost() -> Callable[["Study"], dict]:
    from tipoff.studies.cost import stage

    return stage.run


def _stability() -> Callable[["Study"], dict]:
    from tipoff.studies.stability import stage

    return stage.run


def _ablation() -> Callable[["Study"], dict]:
    from tipoff.studies.ablation import stage

    return stage.run


_stage(
    "compare",
    "Agreement on fitted and held-out conditions beside the floor, and the speed-up; writes "
    "agreement.json.",
    _compare,
)
_stage(
    "cost",
    "What accuracy costs in time, and how it grows with elements, pads, effects; writes cost.json "
    "and cost_study.json.",
    _cost,
)
_stage(
    "stability",
    "Hard cases, each with a simpler method that fails on it; writes stability.json.",
    _stability,
)
_stage(
    "ablation",
    "Every effect off, one at a time: time, rates, what is compiled; writes ablation.json.",
    _ablation,
)


@app.command()
def convergence(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition", metavar="NAME", help="Named condition; default: the first refined one."
        ),
    ] = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Error of the reference itself: meshes, steps, penalty, quadrature; takes minutes; writes
    convergence.json."""

    def work() -> dict:
        from tipoff.studies.convergence import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size, workers=workers), condition
        )

    found = guarded(work, json_)
    if not json_:
        print("\n".join(found["summary"]))


@app.command()
def view(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition", metavar="NAME", help="Named condition; default: the first refined one."
        ),
    ] = None,
    frames: Annotated[
        int,
        typer.Option(
            "--frames", metavar="N", min=2, help="Instants to write, evenly over the run."
        ),
    ] = 60,
    exaggeration: Annotated[
        float | None,
        typer.Option(
            "--exaggeration",
            metavar="X",
            min=1e-6,
            help="Factor of the rail's deformation in pictures; default: one that shows it.",
        ),
    ] = None,
    element_size: ElementSize = None,
    json_: Json = False,
) -> None:
    """Stress and motion of one condition to look at; writes view/CONDITION/ with run.pvd, and
    pictures where pyvista is installed.

    Open run.pvd in ParaView. Rails and payload are there as seen from the platform, undeformed:
    "Warp By Vector" with the array "displacement (m)" and a scale of some hundreds shows how the
    rails give way; colour by "von Mises stress (Pa)" or "contact pressure (Pa)", and play.

      tipoff view --condition phi60 --frames 120
      tipoff view --scene my_launcher.toml --element-size 4 --exaggeration 500

    Pictures (peak.png, ejection.webp) need pyvista, which `make pictures` installs; the files for
    ParaView need nothing more.
    """

    def work() -> dict:
        from tipoff.studies.view import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size), condition, frames, exaggeration
        )

    found = guarded(work, json_)
    if not json_:
        folder = Path(out) / found["scene"]
        print(
            "\n".join(
                f"{folder / path}" for path in (found["collection"], *found["pictures"].values())
            )
        )


@app.command()
def report(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    every: Annotated[
        bool,
        typer.Option(
            "--every",
            help="Make every study that has no present result first (an hour); one "
            "that the scene gives no occasion for says so on the page.",
        ),
    ] = False,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """All of it on one self-contained page; writes report.html and figures/.

    Makes mesh, highfi, lowfi, calibrate, compare, cost, stability and ablation where they are out
    of date (half an hour the first time); every other study is shown if it was made, or made with
    --every.
    """

    def work() -> dict:
        from tipoff.studies.report import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size, workers=workers), every
        )

    guarded(work, json_)


@app.command()
def run(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Annotated[
        str, typer.Option("--condition", metavar="NAME", help="Named condition.")
    ] = "nominal",
    model: Model = None,
    modes: Modes = None,
    calibration: CalibrationFile = None,
    accuracy: Annotated[
        str | None,
        typer.Option(
            "--accuracy",
            metavar="RATE",
            help="Error of the settled rates to be kept, "
            '"0.1 deg/s": takes the cheapest model that make cost found so exact.',
        ),
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option(
            "--budget",
            metavar="TIME",
            help='Wall time to be kept, "2 s": takes the '
            "most exact model that make cost found so fast.",
        ),
    ] = None,
    element_size: ElementSize = None,
    checkpoint_every: CheckpointEvery = None,
    resume: Resume = True,
    json_: Json = False,
) -> None:
    """Run one condition in one model and print what the payload leaves with.

    The answer names its model and, where tipoff compare measured it, its error. The rail's
    compliance is found once per rail and pads. --accuracy and --budget choose a model from what
    tipoff cost measured.

      tipoff run --condition phi35
      tipoff run --condition phi35 --model finite-elements
      tipoff run --condition h4 --accuracy "0.1 deg/s"
    """

    def work() -> dict:
        from tipoff.scenes.faults import Fault, SceneError
        from tipoff.studies.core import models
        from tipoff.studies.runs import single

        asked = models.Asked(model and model.value, calibration, modes)
        study = study_of(
            scene,
            out,
            set_,
            [condition],
            element_size,
            checkpoint_every=checkpoint_every,
            resume=resume,
        )
        if accuracy is None and budget is None:
            models.require(asked, checkpoint_every=checkpoint_every)
            return single.run(study, condition, asked, quiet=json_)
        given = {"--model": model, "--calibration": calibration, "--modes": modes}
        if wrong := [name for name, value in given.items() if value is not None]:
            raise SceneError(
                [
                    Fault(name, "option", "given", "none: --accuracy and --budget choose the model")
                    for name in wrong
                ]
            )
        limits = quantity("--accuracy", accuracy, "deg/s"), quantity("--budget", budget, "s")
        return single.chosen(study, condition, *limits, quiet=json_)

    guarded(work, json_)


@app.command()
def ensemble(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    vary: Annotated[
        str,
        typer.Option(
            "--vary",
            metavar="NAME_OR_FILE",
            help="Distributions: a .toml file, or from the catalogue.",
        ),
    ] = "paper",
    table: Annotated[
        Path | None,
        typer.Option(
            "--table", metavar="FILE", help="CSV table of cases, in place of distributions."
        ),
    ] = None,
    cases: Annotated[
        int | None,
        typer.Option(
            "--cases", metavar="N", min=1, help="Number of cases; default: as the file says."
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed", metavar="N", min=0, help="Seed of all draws; default: as the file says."
        ),
    ] = None,
    sampling: Annotated[
        Sampling | None,
        typer.Option("--sampling", help="How points are drawn; default: as the file says."),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option(
            "--store",
            metavar="DIR",
            help="Folder of the results; default: one of its own for every ensemble.",
        ),
    ] = None,
    case: Annotated[
        int | None,
        typer.Option("--case", metavar="N", min=0, help="Run case N alone and print it."),
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance",
            metavar="X",
            help="Relative error of a step; 1e-2 keeps "
            "95 % of 20 reference cases to 0.2 % of their rate, 1e-4 to 0.1 %.",
        ),
    ] = 1e-2,
    model: Surrogate = None,
    modes: Modes = None,
    calibration: CalibrationFile = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Dask scheduler whose workers run the cases, such as tcp://node1:8786.",
        ),
    ] = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Run the surrogate on thousands to millions of varied cases; writes ensemble.json and a store
    in zarr.

    A file of distributions says what varies; --cases, --seed and --sampling may say otherwise:

      \\[vary."payload.mass"]
      distribution = "normal"
      mean = "9.9 kg"
      sd = "20 g"

    The others are fixed (value), uniform (low, high), truncated-normal (mean, sd, low, high, rule
    "redraw" or "clip") and rayleigh (scale). A table has dotted keys in its first line, units in
    the second or in each cell, and one case in every further line.

      tipoff ensemble --cases 1000000
      tipoff ensemble --vary my_errors.toml --sampling sobol --cases 4096
      tipoff ensemble --table cases.csv --store out/night
      tipoff ensemble --cases 1000000 --case 1234    # that case alone, beside its stored bits

    Stopped, killed or out of disk, the same command goes on from there to the same bits. A bad case
    is refused by itself and listed with its inputs and the reason in the store (done/*.json).
    xarray.open_zarr(STORE + "/cases.zarr") reads the results.
    """

    def work() -> dict:
        from tipoff.studies.core import models
        from tipoff.studies.ensemble import stage

        chosen = models.Asked(model and model.value, calibration, modes)
        models.require(chosen)
        asked = stage.Asked(
            vary,
            table,
            cases,
            seed,
            sampling and sampling.value,
            store,
            tolerance,
            scheduler,
            workers,
            chosen,
        )
        study = study_of(scene, out, set_)
        return stage.run(study, asked) if case is None else stage.case(study, asked, case)

    found = guarded(work, json_)
    if not json_:
        from tipoff.studies.ensemble import stage, summary

        print("\n".join(stage.case_lines(found) if case is not None else summary.lines(found)))


for question in QUESTIONS:
    question.add_command(app)


@app.command()
def bench(
    out: Out = Path("out"),
    element_size: Annotated[
        list[float] | None,
        typer.Option(
            "--element-size",
            metavar="MM",
            min=0.05,
            help="Element size in mm, repeatable; default: 2, 1 and 0.5.",
        ),
    ] = None,
    repeats: Annotated[
        int, typer.Option(metavar="N", min=1, help="Timed repeats; the median counts.")
    ] = 5,
    steps: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Steps of a timed piece; default: by size."),
    ] = None,
    cases: Annotated[
        int, typer.Option(metavar="N", min=1, help="Cases of the surrogate's ensemble.")
    ] = 2000,
    json_: Json = False,
) -> None:
    """Speed of the reference solver against a SciPy matrix and NumPy on the same mesh, and of the
    surrogate against plain Runge-Kutta at the same error; writes bench/highfi.json and
    bench/lowfi.json."""

    def work() -> dict:
        from tipoff.studies.bench import reference, surrogate

        sizes = tuple(1e-3 * size for size in element_size) if element_size else reference.SIZES
        return {
            **reference.run(out, sizes, repeats, steps),
            "surrogate": surrogate.run(out, cases=cases, repeats=repeats),
        }

    guarded(work, json_)


@app.command("scenes")
def list_scenes(
    show: Annotated[
        str | None,
        typer.Option(
            "--show", metavar="NAME", help="Print the file of this one, to begin one's own with."
        ),
    ] = None,
    json_: Json = False,
) -> None:
    """List the catalogue: name, conditions, description.

    tipoff scenes --show reference > my_launcher.toml
    """

    def work() -> dict:
        from tipoff import scenes
        from tipoff.scenes.faults import Fault, SceneError
        from tipoff.scenes.scene import CATALOG

        if show is not None:
            if show not in scenes.catalog():
                raise SceneError(
                    [Fault("--show", "scene", show, f"one of {', '.join(scenes.catalog())}")]
                )
            text = (CATALOG / f"{show}.toml").read_text(encoding="utf-8")
            if not json_:
                print(text, end="")
            return {"scene": show, "file": text}
        found = {name: scenes.load(name) for name in scenes.catalog()}
        if not json_:
            for name, item in found.items():
                print(f"{name:12} {len(item.conditions):3} conditions   {item.description}")
        return {
            "scenes": {
                name: {"description": item.description, "conditions": list(item.conditions)}
                for name, item in found.items()
            }
        }

    guarded(work, json_)


@app.command()
def doctor() -> None:
    """Say whether this machine has everything tipoff needs, and what mends it."""
    from tipoff.studies import doctor as check

    raise typer.Exit(check.main())


flow(app)

if __name__ == "__main__":
    app()
