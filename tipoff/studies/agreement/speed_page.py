"""Wall times of the reference and of the surrogates on the page."""

from typing import TYPE_CHECKING

from tipoff.studies import published
from tipoff.studies.convergence import equal_accuracy
from tipoff.studies.render.document import Caption, Part
from tipoff.studies.render.table import Column, Table, span

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> list[Part]:
    """The section, or how to make its result."""
    equal = (page.documents.get("convergence") or {}).get("equal_accuracy")
    return page.shown("agreement", lambda found: speedups(found, equal), "compare")


def speedups(document: dict, equal: dict | None = None) -> list[Part]:
    """Wall times of the reference and of two surrogates on one machine, their ratios and scatter;
    and those at ``equal`` accuracy, where the convergence study measured them."""
    found = document["speedup_compliant"]
    machine = found["hardware"]
    return [
        _speedup("model compliant", found),
        _speedup("model springs, calibrated", document["speedup"]),
        Caption(
            f"Condition {found['condition']}; all models run alternately in one process, times "
            f"without compilation, on {machine['processor']}, {machine['cores']} cores, "
            f"{machine['memory_gib']} GiB, Python {machine['python']}."
        ),
        _equal(equal),
    ]


def _equal(found: dict | None) -> str:
    """The speed-up at equal accuracy; the mesh of the tables above is fixed."""
    if found is None:
        return "`make convergence` measures the speed-up at equal accuracy."
    printed = float(published.headline()["speedup"])
    return f"{equal_accuracy.sentence(found)}. The paper has {printed:,.0f} for its two models."


def _speedup(model: str, found: dict) -> Table:
    surrogate = [1e3 * value for value in found["lowfi_wall_range_s"]]
    rows = [
        (
            "wall time of one reference run",
            f"{found['highfi_wall_s']:.4g} s",
            f"{found['highfi_repeats']} repeats, {_range(found['highfi_wall_range_s'])} s, "
            f"{found['elements']:,} elements",
        ),
        (
            "wall time of one surrogate run",
            f"{1e3 * found['lowfi_wall_s']:.4g} ms",
            f"{found['lowfi_repeats']} repeats, {_range(surrogate)} ms, compiled",
        ),
        (
            "ratio of wall times",
            found["ratio"],
            f"{found['low']:,.0f} to {found['high']:,.0f} over all pairs of repeats",
        ),
        ("ratio of kernel times", found["kernel_ratio"], "time loops only"),
        ("ratio of processor times", found["cpu_ratio"], "whole process"),
    ]
    return Table((model, Column("value", form=",.0f"), "measurement"), rows)


def _range(values: list[float]) -> str:
    return span(min(values), max(values))
