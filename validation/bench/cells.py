"""What the contact cells and patterns of an ensemble change in its rates, against many cells."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tipoff import front
from tipoff.files import write_json
from tipoff.lowfi.numerics import Numerics
from tipoff.scenes.scene import load
from tipoff.studies.populations.population import TOLERANCE
from tipoff.studies.render.table import Column, Table
from validation.bench import done

FINEST = 40  # cells along each edge of a pad, with the patterns of a single run
MODES = 4  # of each rail: one number for all, because other modes are another change
_MOST_OF_THEM = 0.9  # of the cases: those with rates in one row alone are others
SHARES = (0.5, 0.9, 0.95)


@dataclass(frozen=True)
class Change:
    """Quantiles ``SHARES`` of the change of the rates of a case over their size."""

    cells: int
    degree: int
    median: float
    nine_tenths: float
    nineteen_twentieths: float


def run(out: Path, scene: str, cases: int, element_size: float) -> dict:
    """``rows`` for the numerics of ``tipoff ensemble``, those of ``tipoff run``, and between, for so many
    ``cases`` with the errors of the paper on elements of ``element_size`` (m); writes
    ``out``/bench/cells.json."""
    asked = load(scene)
    walls = front.compliance(asked, element_size)
    many, single = Numerics.of_many(TOLERANCE, MODES), Numerics()
    low, high = many.known_degree or walls.degree, walls.degree

    def rates(cells: int, degree: int) -> np.ndarray:
        numerics: dict[str, Any] = {
            "relative_tolerance": TOLERANCE,
            "modes": MODES,
            "cells": cells,
            "degree": degree,
        }
        found = front.ensemble(asked, "paper", compliance=walls, count=cases, **numerics)
        done.require(f"cases on {cells} cells", found.sizes["case"], cases)
        return found.rate.values

    finest, rows, shares = rates(FINEST, high), [], []
    for cells, degree in ((many.cells, low), (13, low), (single.cells, low), (single.cells, high)):
        changed = np.linalg.norm(rates(cells, degree) - finest, axis=1)
        shares.append((cells, degree, changed / np.linalg.norm(finest, axis=1)))
    # the same cases in each row: those with rates in all of them
    known = np.isfinite([share for *_, share in shares]).all(axis=0)
    for cells, degree, share in shares:
        rows.append(asdict(Change(cells, degree, *np.quantile(share[known], SHARES).tolist())))
    done.require_at_least("cases with rates in all rows", float(known.mean()), _MOST_OF_THEM)
    result = {
        "scene": scene,
        "cases": int(known.sum()),
        "cases_asked": cases,
        "element_size": element_size,
        "rows": rows,
    }
    write_json(Path(out) / "bench" / "cells.json", result)
    return result


def table(found: dict) -> Table:
    """All rows."""
    columns = (
        *(("cells", "cells"), ("degree", "degree")),
        (Column("median", "%", ".2f", 100.0), "median"),
        (Column("90 % of cases", "%", ".2f", 100.0), "nine_tenths"),
        (Column("95 %", "%", ".2f", 100.0), "nineteen_twentieths"),
    )
    note = (
        f"Scene {found['scene']}, {found['cases']} of {found['cases_asked']} cases in elements of "
        f"{1e3 * found['element_size']:g} mm, {MODES} modes of each rail. Change of the rates against {FINEST} cells."
    )
    return Table.of(found["rows"], columns, notes=(note,))
