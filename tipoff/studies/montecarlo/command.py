"""``tipoff montecarlo``: the paper's random errors."""

from typing import TYPE_CHECKING, Annotated, Literal

import typer

from tipoff.studies.commands.options import Seed, Surrogate
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


Cases = Annotated[int, typer.Option("--cases", metavar="N", min=100, help="Number of cases.")]
Meaning = Annotated[
    Literal["signed", "half", "components"],
    typer.Option(
        "--reading",
        help="Axial value of an error: signed normal, its magnitude, or two normal components.",
    ),
]
Direction = Annotated[
    Literal["independent", "shared"],
    typer.Option("--angles", help="One radial angle for each error, or one for all errors."),
]
Rule = Annotated[
    Literal["redraw", "clip", "none"],
    typer.Option("--rule", help="Redraw, clip or keep a value beyond three sigma."),
]
Initial = Annotated[
    bool, typer.Option("--initial", help="Also draw the initial position, within the clearance.")
]
Interface = Annotated[
    bool,
    typer.Option("--interface", help="Also draw the interface stiffness, within a factor of four."),
]
Limit = Annotated[
    list[str] | None,
    typer.Option(
        "--limit",
        metavar="[AXIS=]RATE",
        help='Limit of a rate, "x=2 deg/s", or of the total rate, "5 deg/s"; repeatable. The '
        "result is the probability above it. Default: 5 deg/s for each rate and for the total.",
    ),
]
Reference = Annotated[
    int | None,
    typer.Option(
        "--reference",
        metavar="N",
        min=1,
        help="Also run the first N cases in the finite-element reference. It checks and corrects the "
        "statistics of all cases.",
    ),
]
Finer = Annotated[
    int | None,
    typer.Option(
        "--finer",
        metavar="N",
        min=1,
        help="Number of these cases that also run at half the element size; default: a tenth, at "
        "least 4.",
    ),
]


@scene_command()
def montecarlo(
    request: Request,
    cases: Cases = 1_000_000,
    seed: Seed = 1,
    reading: Meaning = "signed",
    angles: Direction = "independent",
    rule: Rule = "redraw",
    initial: Initial = False,
    interface: Interface = False,
    limit: Limit = None,
    reference: Reference = None,
    finer: Finer = None,
    model: Surrogate = None,
) -> Output:
    """Run random errors of thrust and mass as in the paper's Table 3: quantiles of the rates and
    probabilities above limits, with bounds; writes montecarlo.json.

    The paper has 1,000 cases. Its Table 3 can be read in several ways; all readings are compared.
    Both surrogates run the same cases. With --reference the first cases also run in the finite
    elements. They correct rates, quantiles and probabilities; this writes tails.json.

      tipoff montecarlo --cases 1000000 --limit "x=2 deg/s" --limit "8 deg/s"
      tipoff montecarlo --reading half --angles shared --initial
      tipoff montecarlo --reference 200
    """
    from tipoff.studies.montecarlo import page, stage, tails, tails_page
    from tipoff.studies.populations.random_factors import Reading

    def shown(found: dict) -> "list[Part]":
        return page.summary(found) + tails_page.summary(found["reference"])

    how = Reading(reading, angles, rule, initial, interface)
    options = stage.Options(cases, seed, how, tuple(limit or stage.Options.limits), model)
    study = request.study()
    if reference is None:
        return Output(stage.run(study, options), page.summary, request.out)
    draws = tails.Options(reference, finer, options)
    tails.checked(study, draws)
    found = {**stage.run(study, options), "reference": tails.run(study, draws)}
    return Output(found, shown, request.out)
