"""``tipoff blind``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Neighbours,
    Out,
    SceneName,
    Set,
    Workers,
)
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(blind)


def blind(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    cases: Annotated[
        int,
        typer.Option(
            "--cases",
            metavar="N",
            min=1,
            help="Number of conditions; each takes several runs of the reference, and those of "
            "its neighbours where it is judged as a distribution.",
        ),
    ] = 8,
    vary: Annotated[
        str,
        typer.Option(
            "--vary",
            metavar="NAME_OR_FILE",
            help="Distributions: a .toml file, or a name of the catalogue.",
        ),
    ] = "paper",
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="N",
            min=0,
            help="Seed of the draws; default: a digest of the sources and the scene.",
        ),
    ] = None,
    neighbours: Neighbours = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Agreement of the surrogates on conditions drawn at random after all constants are fixed;
    writes blind.json."""

    def work() -> dict:
        from tipoff.studies.blind import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size, workers=workers),
            stage.Options(cases, vary, seed, neighbours),
        )

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.blind import page

        return page.verdicts(found)

    guarded(work, json_, shown, out)
