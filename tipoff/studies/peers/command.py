"""``tipoff peers``."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.options import Json, Out
from tipoff.studies.commands.running import guarded


def add(app: typer.Typer) -> None:
    """Add the command to ``app``."""
    app.command()(peers)


def peers(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="PEER", help="CalculiX, scikit-fem, Exudyn or MuJoCo; default: all."
        ),
    ] = None,
    out: Out = Path("out"),
    keep: Annotated[
        bool,
        typer.Option(
            "--keep", help="Make these results part of the project, and write docs/peers.md."
        ),
    ] = False,
    json_: Json = False,
) -> None:
    """Solve the same cases in other codes; writes peers/PEER.json.

    A code that is not installed is a row that says so. `make peers` installs those of the package
    index. Takes half an hour.
    """

    def work() -> dict:
        from tipoff.studies.peers import document, stage

        found = stage.run(out, names or ())
        if keep:
            document.keep(out)
        return found

    found = guarded(work, json_)
    if not json_:
        from tipoff.studies.peers import page
        from tipoff.studies.render import document as render

        print(render.terminal(page.parts(found["peers"])))
