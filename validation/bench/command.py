"""``python -m validation bench``, ``waits``, ``ladder`` and ``cells``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import Conditions, Json, Out, SceneName
from tipoff.studies.commands.running import Output, guarded

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def in_millimetres(text: str) -> float:
    """A length with its unit, or a number of millimetres, in mm. Raises typer.BadParameter."""
    from tipoff.scenes.rounding import below
    from tipoff.scenes.units import COARSEST_ELEMENTS, FINEST_ELEMENTS
    from tipoff.units import to_si

    try:
        value = float(text)
    except ValueError:
        try:
            value = 1e3 * to_si(text, "m")
        except ValueError:
            raise typer.BadParameter(
                f'given {text!r}, expected a length, for example "4 mm", or a number of mm'
            ) from None
    least, most = 1e3 * FINEST_ELEMENTS, 1e3 * COARSEST_ELEMENTS
    if below(value, least) or below(most, value):
        raise typer.BadParameter(
            f"given {text!r}, expected at least {least:g} mm, at most {most:g}"
        )
    return value


def bench(
    out: Out = Path("out"),
    element_size: Annotated[
        list[float] | None,
        typer.Option(
            "--element-size",
            metavar="LENGTH",
            parser=in_millimetres,
            help='Element size, "4 mm" or 4, repeatable; default: 2, 1 and 0.5 mm.',
        ),
    ] = None,
    repeats: Annotated[
        int, typer.Option(metavar="N", min=1, help="Timed repeats; the result is the median.")
    ] = 5,
    steps: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1, help="Steps of one timed repeat; default: depends on the mesh."
        ),
    ] = None,
    cases: Annotated[
        int, typer.Option(metavar="N", min=1, help="Cases in the ensemble of the surrogate.")
    ] = 2000,
    json_: Json = False,
) -> None:
    """Measure the speed of both solvers; writes bench/highfi.json, bench/parts.json and
    bench/lowfi.json.

    The reference is compared with a SciPy matrix and with NumPy on the same mesh, and the parts of its
    step are timed, in elements of 8, 4, 2 and 1 mm by default. The surrogate, with
    compliant contact and with springs, is compared with plain Runge-Kutta and solve_ivp at the same
    error.
    """

    def work() -> Output:
        from validation.bench import page, parts, reference, surrogate

        def shown(found: dict) -> "list[Part]":
            names = ("highfi.json", "parts.json", "lowfi.json")
            files = [f"  {out / 'bench' / name}" for name in names]
            return [*page.terminal(found), "\n".join(files)]

        sizes = tuple(1e-3 * size for size in element_size) if element_size else reference.SIZES
        found = {
            **reference.run(out, sizes, repeats, steps),
            "parts": parts.run(out, repeats, sizes if element_size else parts.SIZES),
            "surrogate": surrogate.run(out, cases=cases, repeats=repeats),
        }
        return Output(found, shown)

    guarded(work, json_)


def waits(
    out: Out = Path("out"),
    repeats: Annotated[
        int, typer.Option(metavar="N", min=1, help="Timed repeats; the result is the median.")
    ] = 15,
    length: Annotated[
        list[float] | None,
        typer.Option(metavar="M", help="Length of a rail (m), repeatable; default: 0.25 to 4."),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="waits.json of an earlier state, shown beside."),
    ] = None,
    cold: Annotated[
        bool,
        typer.Option(help="Also the first run, the first report and limits: half an hour."),
    ] = False,
    json_: Json = False,
) -> None:
    """Measure how long a person waits for calls, files, statics and commands; writes
    bench/waits.json."""

    def work() -> Output:
        from tipoff.files import read_json
        from validation.bench import waits

        earlier = read_json(against) if against else None
        rails = {"lengths": tuple(length), "slots": ()} if length else {}
        found = waits.run(out, repeats, cold=cold, **rails)
        return Output(found, lambda found: [waits.table(found, earlier)])

    guarded(work, json_)


def ladder(
    out: Out = Path("out"),
    scene: SceneName = "reference",
    condition: Conditions = None,
    element_size: Annotated[
        float,
        typer.Option(
            "--element-size",
            metavar="LENGTH",
            parser=in_millimetres,
            help='Element size of both models, "4 mm" or 4.',
        ),
    ] = 4.0,
    json_: Json = False,
) -> None:
    """Measure errors and times of compliant contact by degree of the patterns, contact cells and
    modes, against finite elements on the same mesh; writes bench/ladder.json."""

    def work() -> Output:
        from validation.bench import ladder

        names = tuple(name for text in condition or () for name in text.split(","))
        found = ladder.run(out, scene, names, 1e-3 * element_size)
        return Output(found, lambda found: [ladder.table(found)])

    guarded(work, json_)


def cells(
    out: Out = Path("out"),
    scene: SceneName = "reference",
    cases: Annotated[int, typer.Option(metavar="N", min=2, help="Cases of each row.")] = 100,
    element_size: Annotated[
        float,
        typer.Option(
            "--element-size",
            metavar="LENGTH",
            parser=in_millimetres,
            help='Element size of the rails, "4 mm" or 4.',
        ),
    ] = 4.0,
    json_: Json = False,
) -> None:
    """Measure what the contact cells and patterns of tipoff ensemble change in its rates; writes
    bench/cells.json."""

    def work() -> Output:
        from validation.bench import cells

        found = cells.run(out, scene, cases, 1e-3 * element_size)
        return Output(found, lambda found: [cells.table(found)])

    guarded(work, json_)
