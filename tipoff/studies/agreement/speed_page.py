"""Wall times of the reference and of the surrogates on the page."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tipoff.studies.agreement import stage
from tipoff.studies.agreement.equal_accuracy import EqualAccuracy
from tipoff.studies.render.document import Caption, Part
from tipoff.studies.render.table import Column, Table, span
from tipoff.uncertain import LEAST, Measured, rounded
from tipoff.workspace.timing import Speedup

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> list[Part]:
    """The section, or how to make its result."""
    equal = page.equal_accuracy
    return page.shown(stage.STAGE, lambda found: speedups(found, equal), "compare")


def speedups(found: stage.Agreement, equal: EqualAccuracy | None = None) -> list[Part]:
    """Wall times of the reference and of two surrogates on one machine, their ratios and scatter;
    also at ``equal`` accuracy if the convergence study measured it."""
    machine = found.speedup.hardware
    return [
        _speedup("model compliant", found.speedup_compliant),
        _speedup("model springs, calibrated", found.speedup),
        Caption(
            f"Condition {found.speedup.condition}; all models run alternately in one process, times "
            f"without compilation, on {machine['processor']}, {machine['cores']} cores, "
            f"{machine['memory_gib']} GiB, Python {machine['python']}."
        ),
        _equal(equal),
    ]


def _equal(found: EqualAccuracy | None) -> str:
    """The speed-up at equal accuracy; the mesh of the tables above is fixed."""
    if found is None:
        return "`tipoff convergence` measures the speed-up at equal accuracy."
    sentence = found.sentence()
    return f"{sentence[0].upper()}{sentence[1:]}."


def _speedup(model: str, found: Speedup) -> Table:
    surrogate = [1e3 * value for value in found.lowfi_wall_range_s]
    rows = [
        (
            "wall time of one reference run",
            f"{_time(found.highfi_wall_s, found.highfi_wall_range_s)} s",
            f"{found.highfi_repeats} repeats, {_range(found.highfi_wall_range_s)} s, "
            f"{found.elements:,} elements",
        ),
        (
            "wall time of one surrogate run",
            f"{_time(1e3 * found.lowfi_wall_s, surrogate)} ms",
            f"{found.lowfi_repeats} repeats, {_range(surrogate)} ms, compiled",
        ),
        (
            "ratio of wall times",
            Measured(found.ratio, 0.5 * (found.high - found.low), apart=True),
            f"{found.low:,.0f} to {found.high:,.0f} over all pairs of repeats",
        ),
        ("ratio of kernel times", found.kernel_ratio, "time loops only"),
        ("ratio of processor times", found.cpu_ratio, "whole process"),
    ]
    return Table((model, Column("value", form=",.0f"), "measurement"), rows)


def _time(value: float, repeats: Sequence[float]) -> str:
    """A time, rounded to half the range of its repeats."""
    half = 0.5 * (max(repeats) - min(repeats))
    return rounded(value, half, LEAST * half) if half else f"{value:.3g}"


def _range(values: Sequence[float]) -> str:
    return span(min(values), max(values))
