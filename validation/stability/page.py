"""Hard cases."""

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Column, Table
from validation.stability.stage import HardCases
from validation.stability.verdict import Verdict

_NOTE = (
    "Largest step: for the surrogate, the smallest value of the proven limit, which no step "
    "exceeds; for the reference, its time step. Critical step: 2 / ω of the linearised case at "
    "its stiffest, or 2 / rate if friction damps faster. Above it, central differences diverge. "
    "Energy drift: largest residual of the total energy ledger over its scale. A dash: nothing "
    "touches or vibrates, or the value does not apply."
)


def draw(found: HardCases) -> list[Part]:
    """Hard cases, held or not, each with a simpler method that fails."""
    good = [each.held and each.control_failed for each in found.cases]
    title = (
        f"{sum(good)} of {len(good)} hard cases are held where a simpler method fails. A case where it "
        "does not fail proves nothing."
    )
    columns = (
        "name",
        (Column("measure", detail=True), _measure),
        *("fidelity", "figure", "limit", "largest_step_s", "critical_step_s", "energy_drift"),
        *("control", "control_figure"),
        ("verdict", _verdict),
    )
    kinds = ["good" if each else "bad" for each in good]
    return [
        Table.of_records(
            found.cases, *columns, details=(_NOTE,), title=title, kinds=kinds, dense=True
        )
    ]


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
