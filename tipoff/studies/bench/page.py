"""Speed of the solvers on the page."""

from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, section, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> Html:
    """Both solvers against the loops one would write today, where a benchmark was run."""
    found = page.documents.get("bench")
    return bench(found["rows"], found["lowfi"]) if found else Html("")


def bench(rows: list[dict], surrogate: dict | None) -> Html:
    """Speed of the reference solver by mesh, and of the surrogate by error."""
    return section(
        "bench",
        "Speed of the solvers",
        _solver(rows) if rows else Html(""),
        _surrogate(surrogate) if surrogate else Html(""),
    )


def _solver(rows: list[dict]) -> Html:
    heads = (
        "elements",
        "pads pressed (ns)",
        "free (ns)",
        "one thread (ns)",
        "SciPy and NumPy (ns)",
        "ratio",
        "bytes per element",
        "set-up (s)",
        "40 ms would take (h)",
    )
    lines = [
        (
            f"{row['elements']:,}",
            f"{row['ns_per_element_step']:.2f}",
            f"{row['ns_free']:.2f}",
            f"{row['ns_one_thread']:.2f}",
            f"{row['baseline_ns_per_element_step']:.0f}",
            f"{row['ratio']:.1f}",
            f"{row['bytes_per_element']:.0f}",
            f"{row['set_up_s']:.1f}",
            f"{row['projected_40_ms_s'] / 3600.0:.2g}",
        )
        for row in rows
    ]
    first = rows[0]
    return Html(
        table(heads, lines)
        + caption(
            f"Reference: wall time per element and step on {first['threads']} threads, "
            f"{first['faces_in_contact']} pad faces pressed "
            f"or none; medians of {first['repeats']} repeats by turns, compilation apart. Beside "
            f"it central differences with an "
            f"assembled SciPy matrix and NumPy, without contact. {first['hardware']['cores']} "
            f"cores of "
            f"{first['hardware']['processor']}."
        )
    )


def _surrogate(found: dict) -> Html:
    heads = (
        "error of the settled rate (%)",
        "surrogate (ms)",
        "plain Runge-Kutta (ms)",
        "ratio",
        "with curves (ms)",
        "tolerance",
        "step of the plain one (us)",
    )
    lines = [
        (
            f"{row['error_percent']:g}",
            f"{row['cpu_ms']:.3f}",
            f"{row['baseline_cpu_ms']:.3f}",
            f"{row['ratio']:.1f}",
            f"{row['run_cpu_ms']:.2f}",
            f"{row['tolerance']:g}",
            f"{1e6 * row['baseline_dt_s']:.3g}",
        )
        for row in found["single"]
    ]
    many = found["ensemble"]
    return Html(
        table(heads, lines)
        + caption(
            f"Surrogate: processor time of one core per case, the coarsest setting whose 95th "
            f"percentile over {found['varied_cases']} "
            f"varied cases keeps to the error; set-up apart. An ensemble of {many['cases']:,} "
            f"cases at the first error, set-up "
            f"included: {many['cpu_ms_per_case']:.3f} ms of processor time per case, "
            f"{many['wall_s']:.2g} s in all. "
            f"{found['hardware']['processor']}."
        )
    )
