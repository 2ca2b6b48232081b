"""Digests of what the solvers and studies compute, so that a change of the code's shape can be
shown to change no number.

    python -m tests.digests > before.txt                      every catalogue scene, every model
    python -m tests.digests --against before.txt              exit 1 and the lines that differ
    python -m tests.digests --results out > stages.txt        numbers in the stage results below a folder

A line is a name and the first 16 hexadecimal digits of a SHA-256. Times, the machine, versions, and
digests of code are left out.
"""

import argparse
import hashlib
import itertools
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tests.written_names import ARRAYS_OF_REFERENCE
from tipoff import calibration, highfi, lowfi, scenes
from tipoff.calibration import rail_compliance
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory
from validation.bench.surrogate import varied

CATALOG = ("channel", "clamped", "paper_like", "reference", "sensitive", "thin", "tiny", "titanium")
CASES = 1000  # of an ensemble
COARSE = 8e-3  # m, elements of the rails: the numbers need to be the same, not right
# Parts of the names of entries that differ from run to run, or with the code alone.
UNSTABLE = (
    "wall_s",
    "cpu_s",
    "kernel_s",
    "compile_s",
    "seconds",
    "speed",
    "machine",
    "version",
    "sha256",
    "key",
    "files",
    "created",
    "ns_per",
    "threads",
    "times",
)


def digest(*parts: Any) -> str:
    """First 16 hexadecimal digits of the SHA-256 of arrays (their bytes) and plain data (its
    JSON)."""
    total = hashlib.sha256()
    for part in parts:
        total.update(
            np.ascontiguousarray(part).tobytes()
            if isinstance(part, np.ndarray)
            else json.dumps(part, sort_keys=True).encode()
        )
    return total.hexdigest()[:16]


def of_trajectory(run: Trajectory) -> str:
    """Digest of curves, status, outcome and checks."""
    return digest(
        run.status,
        run.message,
        run.outcome._asdict(),
        run.checks,
        run.stress,
        *(getattr(run, name) for name in ARRAYS_OF_REFERENCE),
    )


def trajectories(names: tuple[str, ...]) -> Iterator[str]:
    """A line for each condition of each scene and model; the finite elements run the first
    condition only."""
    for name in names:
        scene = scenes.load(name)
        compliance = calibration.compliance(scene, COARSE)
        yield line(f"{name}/compliance", digest(*_arrays(compliance)))
        walls = rail_compliance.walls(scene)
        for condition in scene.conditions:
            one = scene.condition(condition)
            for model, given in ((COMPLIANT, compliance), (SPRINGS, walls)):
                yield line(
                    f"{name}/{condition}/{model}",
                    of_trajectory(lowfi.run(one, model, compliance=given)),
                )
        first = next(iter(scene.conditions))
        found = highfi.run(scene.condition(first), numerics=highfi.Numerics(element_size=COARSE))
        yield line(f"{name}/{first}/finite-elements", of_trajectory(found))


def ensembles() -> Iterator[str]:
    """A line for a thousand cases of each model of the surrogate."""
    scene, rows = scenes.load("reference"), varied(CASES)
    for model, compliance in ((COMPLIANT, calibration.compliance(scene, COARSE)), (SPRINGS, None)):
        found = lowfi.run_many(scene, rows, model, compliance=compliance)
        columns = {
            name: found[name].values.tolist()
            for name in sorted(found.data_vars)
            if not _is_unstable(name)
        }
        yield line(
            f"ensemble/{model}", digest({name: repr(column) for name, column in columns.items()})
        )


def results(folder: Path) -> Iterator[str]:
    """A line for each entry of each JSON result below ``folder``."""
    for path in sorted(folder.rglob("*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        for entry, value in sorted(
            document.items() if isinstance(document, dict) else [("", document)]
        ):
            if not _is_unstable(entry):
                yield line(f"{path.relative_to(folder)}:{entry}", digest(stable(value)))


def stable(value: Any) -> Any:
    """``value`` without the entries that differ from run to run."""
    if isinstance(value, dict):
        return {name: stable(part) for name, part in value.items() if not _is_unstable(name)}
    return [stable(part) for part in value] if isinstance(value, list) else value


def line(name: str, found: str) -> str:
    """``found`` under its ``name``."""
    return f"{name} {found}"


def _is_unstable(name: str) -> bool:
    return any(part in name for part in UNSTABLE)


def _arrays(compliance: RailCompliance) -> list[np.ndarray]:
    return [value for value in vars(compliance).values() if isinstance(value, np.ndarray)]


def main(arguments: list[str] | None = None) -> int:
    """Print digests; 1 if some differ from those asked for."""
    parser = argparse.ArgumentParser(
        description="Digests of everything the solvers and studies compute."
    )
    parser.add_argument(
        "scenes",
        nargs="*",
        default=CATALOG,
        metavar="SCENE",
        help="catalogue scenes (default: all)",
    )
    parser.add_argument(
        "--results", type=Path, help="a folder of stage results, instead of solving anything"
    )
    parser.add_argument(
        "--against",
        type=Path,
        help="digests printed before; lines that differ are shown, and the exit code is 1",
    )
    asked = parser.parse_args(arguments)
    found = []
    if asked.results:
        lines = results(asked.results)
    else:
        lines = itertools.chain(trajectories(tuple(asked.scenes)), ensembles())
    for item in lines:
        print(item, flush=True)
        found.append(item)
    if asked.against is None:
        return 0
    before = asked.against.read_text(encoding="utf-8").split("\n")
    for item in sorted(set(before) ^ set(found) - {""}):
        print(("- " if item in before else "+ ") + item, file=sys.stderr)
    return int(set(before) - {""} != set(found))


if __name__ == "__main__":
    raise SystemExit(main())
