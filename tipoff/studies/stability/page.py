"""Hard cases on the page."""

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Cells, Column, Noted, Table

_NOTE = (
    "Largest step: for the surrogate, the smallest value of the proven limit, which no step "
    "exceeds; for the reference, its time step. Critical step: 2 / ω of the linearised case at "
    "its stiffest, or 2 / rate if friction damps faster. Above it, central differences diverge. "
    "Energy drift: largest residual of the total energy ledger over its scale. A dash: nothing "
    "touches or vibrates, or the value does not apply."
)


def draw(document: dict) -> list[Part]:
    """Hard cases, held or not, each with a simpler method that fails."""
    columns: Cells = (
        (
            "case",
            lambda c: Noted(
                c["name"], f"{c['measure']}; {c['note']}" if c["note"] else c["measure"]
            ),
        ),
        ("model", "fidelity"),
        ("measured", lambda c: _figure(c["figure"])),
        ("limit", "limit"),
        (Column("largest step", "µs", scale=1e6), "largest_step_s"),
        (Column("critical step", "µs", scale=1e6), "critical_step_s"),
        (Column("energy drift", form=".2g"), "energy_drift"),
        ("simpler method", "control"),
        ("its figure", lambda c: _figure(c["control_figure"])),
        ("verdict", _verdict),
    )
    kinds = ["good" if c["held"] and c["control_failed"] else "bad" for c in document["cases"]]
    title = "For each case a simpler method must fail. Otherwise the case proves nothing."
    return [
        Table.of(document["cases"], columns, notes=(_NOTE,), title=title, kinds=kinds, dense=True)
    ]


def terminal(document: dict) -> list[Part]:
    """Each hard case with its verdict."""
    columns: Cells = (
        ("case", "name"),
        ("model", "fidelity"),
        ("measured", lambda c: _figure(c["figure"])),
        ("limit", "limit"),
        ("simpler method", "control"),
        ("verdict", _verdict),
    )
    good = sum(c["held"] and c["control_failed"] for c in document["cases"])
    title = f"{good} of {len(document['cases'])} hard cases are held where a simpler method fails:"
    return [Table.of(document["cases"], columns, title=title)]


def _figure(value: float | None) -> float | str:
    return "infinite" if value is None else value


def _verdict(case: dict) -> str:
    if not case["held"]:
        return "not held"
    return (
        "held; the simpler method fails"
        if case["control_failed"]
        else "held, but the simpler method holds too"
    )
