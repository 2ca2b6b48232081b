"""Run a command: make its study from the options, turn errors into messages and exit codes."""

import json
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import typer


def study_of(
    scene: str,
    out: Path,
    overrides,
    conditions=None,
    element_size=None,
    workers=None,
    checkpoint_every=None,
    resume=True,
    **settings,
):
    """The study of a scene with the options of a command.

    ``overrides`` are texts "KEY=VALUE"; ``element_size`` is in mm; ``checkpoint_every`` is a time
    with its unit; further ``settings`` are fields of ``Settings``. Raises SceneError, every fault listed.
    """
    from tipoff import scenes
    from tipoff.scenes import plausibility
    from tipoff.scenes.faults import Fault, SceneError
    from tipoff.studies.core.progress import say
    from tipoff.studies.core.settings import defaults
    from tipoff.studies.core.study import Study

    pairs = [item.partition("=") for item in overrides or []]
    if wrong := [item for item, (_, equals, _) in zip(overrides or [], pairs) if not equals]:
        raise SceneError([Fault("--set", item, "no value", "KEY=VALUE") for item in wrong])
    found = scenes.load(scene).replace({key.strip(): value.strip() for key, _, value in pairs})
    chosen = replace(defaults(found.name), resume=resume, **settings)
    if element_size is not None:
        chosen = replace(chosen, element_size=1e-3 * element_size)
    if workers is not None:
        chosen = replace(chosen, workers=workers)
    every = quantity("--checkpoint-every", checkpoint_every, "s")
    if every is not None:
        chosen = replace(chosen, checkpoint_every=every)
    study = Study(found, Path(out) / found.name, chosen, tuple(conditions or ()))
    _ = study.conditions  # raises for a bad override or an unknown condition before anything runs
    for warning in plausibility.of_all_conditions(found):
        say(f"implausible: {warning}")
    return study


def quantity(option: str, text: str | None, unit: str) -> float | None:
    """The value of a ``text`` with unit, in ``unit``; None without a text. Raises SceneError for a
    text that is no quantity of this kind and for a negative value."""
    from tipoff.scenes.faults import Fault, SceneError
    from tipoff.scenes.units import to_si

    if text is None:
        return None
    try:
        value = to_si(text, unit)
    except ValueError as fault:
        raise SceneError([Fault(option, "value", text, str(fault))]) from None
    if value < 0.0:
        raise SceneError([Fault(option, "value", text, "zero or more")])
    return value


def guarded(
    work: Callable[[], dict],
    as_json: bool = False,
    lines: Callable[[dict], list[str]] | None = None,
) -> dict:
    """Run ``work``, print its result as JSON or as text, and return it.

    ``lines`` makes the text from the result. Errors become a message on standard error and an exit
    code: 1 for a failed run and for what this machine refuses, 2 for bad input, 130 for Ctrl-C.
    """
    from tipoff.files import remove_temporaries
    from tipoff.meshes.generator import GmshUnavailable
    from tipoff.scenes.faults import InputError, SceneError
    from tipoff.studies.core.study import StudyError

    try:
        result = work()
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
        # Results are complete at any time, and a thread that compiles a kernel would delay the exit
        # by seconds.
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
        print(json.dumps(result, indent=1))
    if failed := result.get("failed"):
        stop("failed:\n  " + "\n  ".join(failed), 1)
    if lines is not None and not as_json:
        print("\n".join(lines(result)))
    return result


def stop(message: str, code: int) -> NoReturn:
    """End the command with a message on standard error."""
    print(f"tipoff: {message}", file=sys.stderr)
    raise typer.Exit(code)
