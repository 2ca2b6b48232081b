"""The ``tipoff`` command: one sub-command per stage.

Exit codes: 0 done; 1 a run failed (its status gives the reason), or this machine refused a file or
memory; 2 bad input, every fault listed, nothing written. Each command imports the large libraries
that it needs, so that ``--help`` is fast.
"""

import inspect
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from tipoff.studies.commands.options import Json
from tipoff.studies.commands.running import Output, guarded, stop
from tipoff.studies.new_scene.command import new
from tipoff.studies.question import Entry
from tipoff.studies.registry import COMPARISON, ON_DEMAND, QUESTIONS
from tipoff.studies.report.command import report

SUMMARY = "Predict the velocity and the angular rates of a payload when it leaves its rail."
EXAMPLES = """Examples:

  tipoff new my_launcher.toml            # a scene of your own
  tipoff run --scene my_launcher.toml    # velocity and rates
  tipoff run --condition phi15,phi35     # conditions of a scene
  tipoff run --set thrust.peak="7 kN"    # another value
  tipoff report                          # all results on one page
  tipoff compare --scene tiny --json     # results as JSON
"""


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"tipoff {version('tipoff')}")
        raise typer.Exit()


_PICTURES = (".png", ".svg", ".pdf")
# Former names of commands, and what a user types now.
RENAMED = {
    "droptest": "measured",
    "lowfi": "run --all",
    "highfi": "run --all --model finite-elements",
    "blind": "compare --blind N",
    "schema": "scenes --schema",
    "mesh": "view --mesh",
    "sweeps": "sensitivity --sweep N",
}


class _Group(TyperGroup):
    """All commands. The error of a former name states the present one."""

    def resolve_command(self, ctx, args):
        if args and (now := RENAMED.get(args[0])) and args[0] not in self.commands:
            ctx.fail(f"No such command '{args[0]}': it is tipoff {now} now.")
        return super().resolve_command(ctx, args)


app = typer.Typer(
    cls=_Group,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


@app.callback(help=f"{SUMMARY}\n\n{EXAMPLES}")
def main(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and stop."
        ),
    ] = False,
) -> None:
    """Predict the velocity and the angular rates of a payload when it leaves its rail."""


def scenes(
    show: Annotated[
        str | None,
        typer.Option(
            "--show",
            metavar="NAME_OR_FILE",
            help="Print the file of this scene, or of these errors, for a changed copy; of a file of yours, all "
            "that follows from its buttons or its deployer, its origin and its body, as if written by hand.",
        ),
    ] = None,
    draw: Annotated[
        Path | None,
        typer.Option(
            "--draw",
            metavar="FILE.png",
            help="With --show: draw the launcher to scale instead, from the side and from its open end.",
        ),
    ] = None,
    schema: Annotated[
        bool,
        typer.Option(
            "--schema",
            help="Print the JSON schema of scene files. With it, an editor completes and checks these "
            "files.",
        ),
    ] = False,
    json_: Json = False,
) -> None:
    """List the scenes of the catalogue: name, number of conditions, description.

      tipoff scenes --show reference > my_launcher.toml
      tipoff scenes --show paper > my_errors.toml
      tipoff scenes --show my_rocket.toml --draw my_rocket.png
      tipoff scenes --schema > tipoff.schema.json

    An editor with Even Better TOML or taplo uses the schema if a file begins with the line
    #:schema ./tipoff.schema.json
    """

    def work() -> Output:
        from tipoff import toml
        from tipoff.faults import Fault, SceneError, close
        from tipoff.files import replacing
        from tipoff.scenes import catalog, load, reading, uncertainty
        from tipoff.scenes.scene import CATALOG
        from tipoff.scenes.schema import schema as rules
        from tipoff.workspace.progress import say

        if schema:
            if show is not None:
                raise SceneError([Fault("--show", "option", show, "none with --schema")])
            return Output(
                {"schema": rules()}, lambda found: [json.dumps(found["schema"], indent=1)]
            )
        if draw is not None:
            if show is None:
                raise SceneError([Fault("--draw", "option", "no --show", "a scene to draw")])
            if draw.suffix not in _PICTURES:
                words = f"a file that ends with {', '.join(_PICTURES)}"
                raise SceneError([Fault("--draw", "file", str(draw), words)])
            with replacing(draw) as path:
                load(show).plot().savefig(path, format=draw.suffix[1:], dpi=150)
            say(f"the launcher: {draw}")
            return Output({"scene": show, "drawing": str(draw)})
        if show is not None and (show.endswith(".toml") or Path(show).is_file()):
            text = toml.dumps({"format": reading.FORMAT} | load(show).written_out())
            if not json_:
                print(text, end="")
            return Output({"scene": show, "file": text})
        if show is not None:
            scenes = {name: CATALOG / f"{name}.toml" for name in catalog()}
            errors = {  # those of a scene have its name
                f"vary/{path.stem}" if path.stem in scenes else path.stem: path
                for path in sorted(uncertainty.CATALOG.glob("*.toml"))
            }
            if show not in (known := scenes | errors):
                words = f"one of {', '.join(known)}{close(show, known)}"
                raise SceneError([Fault("--show", "name", show, words)])
            text = known[show].read_text(encoding="utf-8")
            if not json_:
                print(text, end="")
            return Output({"scene": show, "file": text})
        found = {name: load(name) for name in catalog()}
        if not json_:
            for name, item in found.items():
                print(f"{name:12} {len(item.conditions):3} conditions   {item.description}")
        described = {
            name: {"description": item.description, "conditions": list(item.conditions)}
            for name, item in found.items()
        }
        return Output({"scenes": described})

    guarded(work, json_)


def doctor() -> None:
    """Check whether this machine has everything that tipoff needs; prints how to repair a fault."""
    from tipoff.studies import doctor as check

    raise typer.Exit(check.main())


def flowed(text: str) -> str:
    """``text`` with each paragraph on one line; indented paragraphs are unchanged."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(
        item if item.startswith(" ") else " ".join(item.split()) for item in paragraphs
    )


_IN_THE_FILE = "the file of errors states it, as its key {0}: --vary FILE"
_MOVED = {
    ("scenes", "--pads"): "--show FILE.toml writes out all that follows from the parts of a scene",
    **{
        (name, "--seed"): _IN_THE_FILE.format("seed") for name in ("ensemble", "flight", "measured")
    },
    ("ensemble", "--sampling"): _IN_THE_FILE.format("sampling"),
    (
        "",
        "--element-size",
    ): '--set studies.element_size="4 mm", or this key in the scene, states it',
    ("", "--strict"): "tipoff run --strict refuses implausible values",
    **{
        ("flight", f"--{key}"): f"--set flight.{key}=VALUE replaces the value of the scene"
        for key in ("altitude", "duration", "range")
    },
}


class _Command(TyperCommand):
    """A command whose help lists formats of files. Their readers load when the help is shown. The refusal
    of an option that was moved says where it is now."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        for given in args:
            option = given.partition("=")[0]
            known = any(option in each.opts for each in self.params)
            words = _MOVED.get((self.name or "", option), _MOVED.get(("", option)))
            if words and not known:
                stop(f"{option}: option: no longer one: {words}", 2)
        return super().parse_args(ctx, args)

    @property
    def help(self) -> str:
        from tipoff.formats.declared import filled

        return filled(self._help)

    @help.setter
    def help(self, text: str) -> None:
        self._help = text


def _listed(title: str, commands: Iterable[Callable[..., None]]) -> None:
    for command in commands:
        text = flowed(command.__doc__ or "")
        first = text.partition("\n\n")[0]  # in the list of all commands
        app.command(help=text, short_help=first, rich_help_panel=title, cls=_Command)(command)


def add(title: str, entries: Iterable[Entry]) -> None:
    """Add the commands of studies; ``title`` is their group in the help."""
    _listed(title, [command for entry in entries for command in entry.commands])


_listed("Scenes and this machine", [new, scenes, doctor])
add("Answers", ON_DEMAND)
_listed("Answers", [report])
add("Surrogate against finite elements", COMPARISON)
add("Studies", QUESTIONS)

if __name__ == "__main__":
    app()
