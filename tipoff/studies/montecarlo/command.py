"""``tipoff montecarlo``: the paper's random errors."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.asked import guarded, study_of
from tipoff.studies.commands.options import Json, Out, SceneName, Set, Surrogate, Workers


class Values(StrEnum):
    """What a normal axial value may be."""

    signed = "signed"
    half = "half"
    components = "components"


class Angles(StrEnum):
    """Whose the radial angles are."""

    independent = "independent"
    shared = "shared"


class Rules(StrEnum):
    """What may become of a draw beyond three sigma."""

    redraw = "redraw"
    clip = "clip"
    none = "none"


Cases = Annotated[int, typer.Option("--cases", metavar="N", min=100, help="Number of cases.")]
Seed = Annotated[int, typer.Option("--seed", metavar="N", min=0, help="Seed of all draws.")]
Meaning = Annotated[
    Values,
    typer.Option(
        "--reading", help="What a normal axial value is: signed, its size, or two components."
    ),
]
Direction = Annotated[
    Angles, typer.Option("--angles", help="A radial angle for each error, or one that all share.")
]
Rule = Annotated[Rules, typer.Option("--rule", help="What becomes of a draw beyond three sigma.")]
Initial = Annotated[
    bool, typer.Option("--initial", help="Draw the place inside the clearance at ignition too.")
]
Limit = Annotated[
    list[str] | None,
    typer.Option(
        "--limit",
        metavar="[AXIS=]RATE",
        help='How often is a rate above it? "x=2 '
        'deg/s", or "5 deg/s" for the total; '
        "repeatable. Default: 5 deg/s for each "
        "and the total.",
    ),
]


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""

    @app.command()
    def montecarlo(
        scene: SceneName = "reference",
        out: Out = Path("out"),
        set_: Set = None,
        cases: Cases = 1_000_000,
        seed: Seed = 1,
        reading: Meaning = Values.signed,
        angles: Direction = Angles.independent,
        rule: Rule = Rules.redraw,
        initial: Initial = False,
        limit: Limit = None,
        model: Surrogate = None,
        workers: Workers = None,
        json_: Json = False,
    ) -> None:
        """Random errors of thrust and mass as in the paper's Table 3: rates, tails, and the
        uncertainty of both; writes montecarlo.json.

        The first thousand cases are the paper's number. All readings of the table are compared, and
        both surrogates on equal draws.

          tipoff montecarlo --cases 1000000 --limit "x=2 deg/s" --limit "8 deg/s"
          tipoff montecarlo --reading half --angles shared --initial
        """

        def work() -> dict:
            from tipoff.studies.montecarlo import stage
            from tipoff.studies.populations.random_factors import Reading

            how = Reading(reading.value, angles.value, rule.value, initial)
            options = stage.Options(
                cases, seed, how, tuple(limit or stage.Options.limits), model and model.value
            )
            return stage.run(study_of(scene, out, set_, workers=workers), options)

        found = guarded(work, json_)
        if not json_:
            print("\n".join([*found["findings"], *found["summary"]]))
