"""Hard cases on the page."""

from dataclasses import replace

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Noted, Table
from tipoff.studies.stability.stage import HardCases
from tipoff.studies.stability.verdict import Verdict

_NOTE = (
    "Largest step: for the surrogate, the smallest value of the proven limit, which no step "
    "exceeds; for the reference, its time step. Critical step: 2 / ω of the linearised case at "
    "its stiffest, or 2 / rate if friction damps faster. Above it, central differences diverge. "
    "Energy drift: largest residual of the total energy ledger over its scale. A dash: nothing "
    "touches or vibrates, or the value does not apply."
)


def draw(found: HardCases) -> list[Part]:
    """Hard cases, held or not, each with a simpler method that fails."""
    steps = ("largest_step_s", "critical_step_s", "energy_drift")
    case = ("case", lambda each: Noted(each.name, _measure(each)))
    columns = (case, *_FIGURES, *steps, "control", "control_figure", _VERDICT)
    kinds = ["good" if each.held and each.control_failed else "bad" for each in found.cases]
    title = "For each case a simpler method must fail. Otherwise the case proves nothing."
    table = Table.of_records(found.cases, *columns, notes=(_NOTE,), title=title, kinds=kinds)
    return [replace(table, dense=True)]


def terminal(found: HardCases) -> list[Part]:
    """Each hard case with its verdict."""
    good = sum(each.held and each.control_failed for each in found.cases)
    title = f"{good} of {len(found.cases)} hard cases are held where a simpler method fails:"
    return [Table.of_records(found.cases, "name", *_FIGURES, "control", _VERDICT, title=title)]


def _measure(case: Verdict) -> str:
    return f"{case.measure}; {case.note}" if case.note else case.measure


def _verdict(case: Verdict) -> str:
    if not case.held:
        return "not held"
    return (
        "held; the simpler method fails"
        if case.control_failed
        else "held, but the simpler method holds too"
    )


_FIGURES = ("fidelity", "figure", "limit")
_VERDICT = ("verdict", _verdict)
