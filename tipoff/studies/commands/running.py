"""Run a command: make its study from the options, turn errors into messages and exit codes."""

import json
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NoReturn, TypeVar

import typer

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part
    from tipoff.workspace.stage import Made


_T = TypeVar("_T")


class Output(NamedTuple):
    """The output of a command: its ``result`` as JSON, or the parts that ``shown`` makes of it for
    the terminal, followed by the files of the stage in the folder ``out``."""

    result: dict
    shown: "Callable[[dict], Sequence[Part]] | None" = None
    out: Path | None = None

    @classmethod
    def of(
        cls,
        made: "Made[_T]",
        shown: "Callable[[_T], Sequence[Part]]",
        out: Path | None = None,
    ) -> "Output":
        """The output of a stage, whose typed result ``shown`` gets."""
        return cls(made.document, lambda _: shown(made.result), out)


def study_of(
    scene: str,
    out: Path,
    overrides,
    conditions=None,
    workers=None,
    checkpoint_every=None,
    strict=False,
    **settings,
):
    """The study of a scene with the options of a command.

    ``overrides`` are texts "KEY=VALUE", ``conditions`` names, also several with commas between
    them; ``checkpoint_every`` is a time with its unit; ``strict`` refuses implausible values; further
    ``settings`` are fields of ``Settings``. Raises SceneError, every fault listed.
    """
    from tipoff import scenes
    from tipoff.faults import Fault, SceneError
    from tipoff.highfi.rail.geometry import require_walls
    from tipoff.scenes import implausible, reading
    from tipoff.workspace.progress import say
    from tipoff.workspace.settings import defaults
    from tipoff.workspace.study import Study

    pairs = [item.partition("=") for item in overrides or []]
    if wrong := [item for item, (_, equals, _) in zip(overrides or [], pairs) if not equals]:
        raise SceneError([Fault("--set", item, "no value", "KEY=VALUE") for item in wrong])
    is_file = scene.endswith(".toml")
    named = {} if is_file else {"source": "--scene", "key": "name", "given": repr(scene)}
    loaded = _of_option(named, lambda: scenes.load(scene))
    changes = {key.strip(): value.strip() for key, _, value in pairs}
    found = _of_option({"source": "--set"}, lambda: loaded.replace(changes))
    chosen = replace(defaults(found), **settings)
    if workers is not None:
        chosen = replace(chosen, workers=workers)
    every = quantity("--checkpoint-every", checkpoint_every, "s", "5 min")
    if every is not None:
        chosen = replace(chosen, checkpoint_every=every)
    names = [name.strip() for item in conditions or () for name in item.split(",")]
    study = Study(found, Path(out) / found.name, chosen, tuple(dict.fromkeys(names)))
    # a bad override or an unknown condition, before anything runs
    asked = {"source": "--condition", "key": "name"} if names else {}
    _of_option(asked, lambda: study.conditions)
    doubtful = implausible.of_all_conditions(found)
    if doubtful and strict:
        raise SceneError(
            [
                Fault(found.name, key, given, "a plausible value with --strict")
                for key, _, given in (words.partition(": ") for words in doubtful)
            ]
        )
    for warning in doubtful:
        say(f"implausible: {warning}")
    require_walls(found, found.conditions)
    _require_time(study)  # after the warnings, which may state why a thrust lasts too long
    replaced = _replaced(changes, study)
    for warning in [*reading.replaced_by_conditions(scene), *replaced]:
        say(f"warning: {warning}")
    return study


def _require_time(study) -> None:
    """Refuse a stated duration in which no payload can settle, before anything is compiled."""
    from tipoff.faults import Fault, SceneError
    from tipoff.results import unfinished
    from tipoff.units import duration

    asked = {name: study.scene.condition(name) for name in study.conditions}
    faults: dict[tuple[str, str], Fault] = {}
    for name, scene in asked.items():
        if words := unfinished.foreseen(scene):
            given = duration(scene.duration)
            faults.setdefault(
                (given, words), Fault(f"{scene.name}, {name}", "duration", given, words)
            )
    if faults:
        raise SceneError(list(faults.values()))


def _replaced(changes: dict[str, str], study) -> list[str]:
    """Warnings: ``changes`` by --set that the conditions of the study replace by their own values."""
    found = []
    for key in changes:
        names = [
            name
            for name in study.conditions
            if any(
                f"{key}.".startswith(f"{own}.") or f"{own}.".startswith(f"{key}.")
                for own in study.scene.conditions.get(name, ())
            )
        ]
        if names:
            found.append(
                f"--set: {key}: the conditions {', '.join(names)} replace this value by their own; to "
                f"change a condition, --set conditions.{names[0]}.{key}=VALUE"
            )
    return found


def _of_option(named: dict[str, str], work: Callable[[], _T]) -> _T:
    """The result of ``work``; its faults become faults of an option, with fields renamed by
    ``named``."""
    from tipoff.faults import SceneError

    try:
        return work()
    except SceneError as error:
        raise SceneError([fault._replace(**named) for fault in error.faults]) from None


def quantity(option: str, text: str | None, unit: str, example: str) -> float | None:
    """The value of a ``text`` with unit, in ``unit``; None without a text. Raises SceneError, with an
    ``example``, for a text that is no quantity of this kind and for a negative value."""
    from tipoff.faults import Fault, SceneError
    from tipoff.units import to_si

    if text is None:
        return None
    try:
        value = to_si(text, unit)
    except ValueError as fault:
        expected = str(fault).replace(f'"1 {unit}"', f'"{example}"')
        raise SceneError([Fault(option, "value", text, expected)]) from None
    if value < 0.0:
        raise SceneError([Fault(option, "value", text, "zero or more")])
    return value


PROGRAMS: dict[str, str] = {}  # by the names of commands of studies from outside the package


def program(command: str) -> str:
    """The program that has a ``command``, with or without options, as the user would type it."""
    return PROGRAMS.get(command.split()[0], "tipoff")


def guarded(work: Callable[[], Output], as_json: bool = False) -> None:
    """Run ``work`` and print its result as JSON or as text.

    Errors become a message on standard error and an exit code: 1 for a failed run and for a refusal
    of this machine, 2 for bad input, 130 for Ctrl-C.
    """
    from tipoff.faults import InputError, SceneError
    from tipoff.files import remove_temporaries
    from tipoff.meshes.generator import GmshUnavailable
    from tipoff.workspace.study import StudyError

    try:
        output = work()
    except SceneError as fault:
        stop(str(fault), 2)
    except (StudyError, GmshUnavailable) as fault:
        stop(str(fault), 1)
    except KeyboardInterrupt:
        print(
            "tipoff: stopped; finished results are stored, and the same command continues",
            file=sys.stderr,
            flush=True,
        )
        # Stored results are complete at any time. A thread that compiles a kernel would delay the
        # exit by seconds.
        remove_temporaries()
        os._exit(130)
    except InputError as fault:
        stop(f"{type(fault).__name__}: {fault}", 2)
    except OSError as fault:  # a full disk, a folder that cannot be written
        place = f"{fault.filename}: " if fault.filename else ""
        stop(f"{place}{fault.strerror or fault}", 1)
    except MemoryError as fault:
        stop(f"memory does not suffice ({fault})" if str(fault) else "memory does not suffice", 1)
    if as_json:
        from tipoff.workspace import words

        print(json.dumps({"quantities": words.QUANTITIES, **output.result}, indent=1))
        unshown = ""
    else:
        unshown = _print(output)
    failed = [*output.result.get("failed", ()), *([f"text: {unshown}"] if unshown else [])]
    if failed:
        stop("failed:\n  " + "\n  ".join(failed), 1)


def _print(output: Output) -> str:
    """Print the result and its files. Returns the reason if the result cannot be shown."""
    result, shown, out = output
    reason = ""
    if shown is not None:
        from tipoff.studies.render import document
        from tipoff.workspace.attempt import attempt

        text, reason = attempt("the text of the result", lambda: document.terminal(shown(result)))
        if text is not None:
            print(text)
    if out is not None:
        print("\n".join(files(result, out)))
    return reason


def files(result: dict, out: Path) -> list[str]:
    """One line for each file of a stage below the folder ``out``, new or old; a folder with more
    than three files has one line."""
    folder = Path(out) / result["scene"]
    listed: dict[str, list[str]] = {}
    for name in (f"{result['stage']}.json", *result.get("files", ())):
        listed.setdefault(name.rpartition("/")[0], []).append(name)
    return [
        f"  {line}"
        for place, names in listed.items()
        for line in (
            map(str, (folder / name for name in names))
            if not place or len(names) <= 3
            else [f"{folder / place}/ ({len(names)} files)"]
        )
    ]


def stop(message: str, code: int) -> NoReturn:
    """End the command with a message on standard error."""
    print(f"tipoff: {message}", file=sys.stderr)
    raise typer.Exit(code)
