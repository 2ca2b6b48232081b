"""Speed of the solvers on the page."""

from typing import TYPE_CHECKING

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Cells, Column, Table
from validation.bench import parts

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_REFERENCE: Cells = (
    ("elements", "elements"),
    (Column("pads pressed", "ns", ".2f"), "ns_per_element_step"),
    (Column("free", "ns", ".2f"), "ns_free"),
    (Column("one thread", "ns", ".2f"), "ns_one_thread"),
    (Column("SciPy and NumPy", "ns", ".0f"), "baseline_ns_per_element_step"),
    (Column("ratio", form=".1f"), "ratio"),
    (Column("bytes per element", form=".0f"), "bytes_per_element"),
    (Column("set-up", "s", ".1f"), "set_up_s"),
    (Column("projected run of 40 ms", "h", ".2g", 1.0 / 3600.0), "projected_40_ms_s"),
)
_SURROGATE: Cells = (
    (Column("error of the settled rate", "%", "g"), "error_percent"),
    ("method", "method"),
    (Column("time per case", "ms", ".3f"), "cpu_ms"),
    (Column("with curves", "ms", ".2f"), "run_cpu_ms"),
    (Column("with curves and modes chosen", "ms", ".2f"), "run_auto_cpu_ms"),
    (Column("tolerance, or step in s", form=".3g"), "setting"),
)


def draw(page: "Page") -> list[Part]:
    """Both solvers and their baselines; empty without a benchmark."""
    found = page.results.get("bench") or {}
    parts: list[Part] = [_reference(found["rows"])] if found.get("rows") else []
    return [*parts, _surrogate(found["lowfi"])] if found.get("lowfi") else parts


def terminal(found: dict) -> list[Part]:
    """The result of the command for the terminal."""
    return [_reference(found["rows"]), parts.table(found["parts"]), _surrogate(found["surrogate"])]


def _reference(rows: list[dict]) -> Table:
    """Time of the reference by mesh."""
    first = rows[0]
    machine = first["hardware"]
    note = (
        f"Reference: wall time per element and step on {first['threads']} threads, with "
        f"{first['faces_in_contact']} pad faces pressed or none; median of {first['repeats']} "
        "repeats without compilation. Friction of pads at rest divides a step into parts, and each "
        "of them steps all elements; the time is divided by the parts. Baseline: central "
        "differences with an assembled SciPy matrix and NumPy, without contact. Machine: "
        f"{machine['cores']} cores of {machine['processor']}."
    )
    return Table.of(rows, _REFERENCE, notes=(note,))


def _surrogate(found: dict) -> Table:
    """Time of the surrogate and of the baselines by error."""
    many = "; ".join(
        f"on {row['method']} {row['cpu_ms_per_case']:.3f} ms of processor time per case, "
        f"{row['wall_s']:.2g} s in total"
        for row in found["ensembles"]
    )
    note = (
        "Surrogate: processor time of one core per case, without set-up. The setting is the "
        "coarsest one whose error is within that of the row (95th percentile over "
        f"{found['varied_cases']} varied cases). The baselines have compiled equations and no "
        "events: plain Runge-Kutta of order four with fixed steps, and solve_ivp with steps of "
        "at most 1 ms. Longer steps miss contacts. Ensembles of "
        f"{found['ensembles'][0]['cases']:,} cases at the first error, set-up and the choice of "
        f"modes included, take {many}. Modes of compliant contact: {found['modes_why']}; under "
        f"'modes chosen' each run has its own. Machine: {found['hardware']['processor']}."
    )
    return Table.of(found["single"], _SURROGATE, notes=(note,))
