"""Wall times of the reference and of the surrogates on the page."""

from typing import TYPE_CHECKING

from tipoff.studies import published
from tipoff.studies.convergence import equal_accuracy
from tipoff.studies.render.markup import Html, caption, joined, paragraph, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""
    equal = (page.documents.get("convergence") or {}).get("equal_accuracy")
    return page.section(
        "agreement", "speedup", "Speed", lambda found: speedups(found, equal), "compare"
    )


def speedups(document: dict, equal: dict | None = None) -> Html:
    """Wall times of the reference and of two surrogates on one machine, their ratios and the
    scatter; and those at ``equal`` accuracy, where the error of the reference was studied."""
    found = document["speedup_compliant"]
    machine = found["hardware"]
    return joined(
        paragraph("Model compliant:"),
        _speedup(found),
        paragraph("Model springs, calibrated:"),
        _speedup(document["speedup"]),
        caption(
            f"Condition {found['condition']}, all models by turns in one go, all included but "
            f"compilation, on {machine['processor']}, "
            f"{machine['cores']} cores, {machine['memory_gib']} GiB, Python {machine['python']}."
        ),
        _equal(equal),
    )


def _equal(found: dict | None) -> Html:
    """The mesh above is fixed; the one that a speed-up should be measured on is as sure as the
    surrogate is exact."""
    if found is None:
        return paragraph(
            "How much faster at equal accuracy: make convergence tells, on the mesh that is as "
            "sure as the surrogate "
            "is exact."
        )
    said = equal_accuracy.sentence(found)
    asked = float(published.headline()["speedup"])
    return paragraph(f"{said[0].upper()}{said[1:]}. The paper has {asked:,.0f} for its two models.")


def _speedup(found: dict) -> Html:
    rows = [
        (
            "wall time of one reference run",
            f"{found['highfi_wall_s']:.4g} s",
            f"{found['highfi_repeats']} repeats, "
            f"{_range(found['highfi_wall_range_s'])} s, {found['elements']:,} elements",
        ),
        (
            "wall time of one surrogate run",
            f"{1e3 * found['lowfi_wall_s']:.4g} ms",
            f"{found['lowfi_repeats']} repeats, "
            f"{_range([1e3 * value for value in found['lowfi_wall_range_s']])} ms, warm",
        ),
        (
            "ratio of wall times",
            f"{found['ratio']:,.0f}",
            f"{found['low']:,.0f} to {found['high']:,.0f} over all pairs of repeats",
        ),
        (
            "ratio of kernels alone",
            _whole(found["kernel_ratio"]),
            "time loops only, without set-up and output",
        ),
        ("ratio of processor times", _whole(found["cpu_ratio"]), "of the whole process"),
    ]
    return table(("", "value", "how measured"), rows)


def _range(values: list[float]) -> str:
    return f"{min(values):.3g} to {max(values):.3g}"


def _whole(value: float | None) -> str:
    return "–" if value is None else f"{value:,.0f}"
