"""``python -m validation peers``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import Json, Out
from tipoff.studies.commands.running import Output, guarded

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


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

    The result lists codes that are not installed as missing. `make peers` installs the codes of the
    Python package index. The command takes half an hour.
    """

    def work() -> Output:
        from validation.documents import peers as document
        from validation.peers import page, stage

        def shown(found: dict) -> "list[Part]":
            folder = out / "peers"
            written = [f"  {folder}/"] if folder.is_dir() else []
            return [*page.parts(found["peers"]), *written]

        found = stage.run(out, names or ())
        if keep:
            document.keep(out)
        return Output(found, shown)

    guarded(work, json_)
