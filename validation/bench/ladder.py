"""Errors of compliant contact against the finite elements by degree of the patterns, contact cells
and modes, and the time of each: rungs from the default to the most accurate.

Each timed run must end as the first one did, after as many steps. Both models have the same mesh, so its
error is not in the table.
"""

import statistics
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tipoff import front
from tipoff.comparison.metrics import compare
from tipoff.files import write_json
from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.mechanics.rail_compliance import MODES, RailCompliance
from tipoff.scenes.scene import load
from tipoff.studies.render.table import Column, Table
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from validation.bench import done

# degree of the patterns, modes of each rail
RUNGS: tuple[tuple[int, int | str], ...] = (
    (2, AUTO),
    (3, 0),
    (3, AUTO),
    (3, MODES),
    (4, MODES),
    (5, MODES),
)
_REPEATS = 5


@dataclass(frozen=True)
class Step:
    """One condition on one rung; errors are None if a run did not settle."""

    condition: str
    degree: int
    modes: str  # of each rail; with the number that the run chose, if it chose
    settled_error_deg_s: float | None  # largest of a settled rate
    rate_l2: float | None  # relative
    steps: int  # of each timed run
    wall_ms: float
    reference_wall_s: float


def run(out: Path, scene: str, conditions: tuple[str, ...], element_size: float) -> dict:
    """``rows``, one for each condition and rung, in elements of ``element_size`` (m) for both
    models; writes ``out``/bench/ladder.json. Default: all conditions."""
    every = load(scene)
    walls: dict[int, RailCompliance] = {}
    rows: list[Step] = []
    for name in conditions or tuple(every.conditions):
        asked = every.condition(name)
        reference = front.run(asked, FINITE_ELEMENTS, element_size=element_size)
        done.require_run(f"{name}, finite elements", reference)
        for degree, modes in RUNGS:
            if degree not in walls:
                walls[degree] = front.compliance(every, element_size, degree)
            numerics: dict[str, Any] = {"compliance": walls[degree], "modes": modes}
            numerics["sensitivity"] = False
            found, times = front.run(asked, **numerics), []
            done.require_run(f"{name}, degree {degree}, modes {modes}", found)
            ended = found.status, found.cost["steps"]
            for _ in range(_REPEATS):
                began = time.perf_counter()
                again = front.run(asked, **numerics)
                times.append(time.perf_counter() - began)
                if (again.status, again.cost["steps"]) != ended:
                    raise done.NotDone(
                        f"a timed run of {name} did not end as the first one: {ended}"
                    )
            difference = compare(reference, found)
            rows.append(
                Step(
                    condition=name,
                    degree=degree,
                    modes=f"auto, {found.cost['modes']}" if modes == AUTO else str(modes),
                    settled_error_deg_s=difference.settled_rate_error_deg_s,
                    rate_l2=difference.rate_relative_l2,
                    steps=int(found.cost["steps"]),
                    wall_ms=1e3 * statistics.median(times),
                    reference_wall_s=reference.cost["wall_s"],
                )
            )
        say(f"  {name}: done")
    result = {
        "scene": scene,
        "element_size": element_size,
        "rows": [asdict(row) for row in rows],
        "hardware": machine.describe(),
        "state": machine.state(),
    }
    write_json(Path(out) / "bench" / "ladder.json", result)
    return result


def table(found: dict) -> Table:
    """All rows."""
    columns = (
        *(("condition", "condition"), ("degree", "degree"), ("modes", "modes")),
        (Column("settled error", "deg/s", ".3f"), "settled_error_deg_s"),
        (Column("rate L2", "%", ".2f", 100.0), "rate_l2"),
        ("steps", "steps"),
        (Column("wall time", "ms", ".3g"), "wall_ms"),
        (Column("finite elements", "s", ".3g"), "reference_wall_s"),
    )
    note = (
        f"Scene {found['scene']}, both models in elements of {1e3 * found['element_size']:g} mm. "
        f"Times are medians of {_REPEATS} runs one after another, kernels compiled."
    )
    return Table.of(found["rows"], columns, notes=(note,))
