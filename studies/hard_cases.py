"""Hard cases, each with a control: a simpler method that must be seen to fail on it, or the case proves nothing.

A case is a function without arguments that returns a ``Verdict``. ``CASES`` is the registry the stability stage runs.
"""

from typing import Callable, NamedTuple


class Verdict(NamedTuple):
    """One line of the stability table. ``figure`` is what was measured against ``limit`` (dimensionless unless ``measure`` says
    otherwise), ``control_figure`` the same measure of the weaker method; infinite values are given as None."""

    name: str
    fidelity: str
    measure: str
    figure: float | None
    limit: float
    held: bool
    control: str
    control_figure: float | None
    control_failed: bool
    note: str = ""


def verdict(name: str, fidelity: str, measure: str, figure: float, limit: float, control: str, control_figure: float,
            note: str = "", holds: bool = True) -> Verdict:
    """A verdict from the two figures; ``holds`` adds conditions that are not numbers (a refusal, a status)."""
    return Verdict(name, fidelity, measure, _finite(figure), limit, bool(holds and figure <= limit), control,
                   _finite(control_figure), not bool(control_figure <= limit), note)


def _finite(value: float) -> float | None:
    return float(value) if abs(value) < float("inf") else None


def cases() -> dict[str, Callable[[], Verdict]]:
    """Every case by name."""
    from studies import hard_elastic, hard_rigid

    return {**hard_rigid.CASES, **hard_elastic.CASES}
