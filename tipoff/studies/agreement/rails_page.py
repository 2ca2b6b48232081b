"""Agreement on other rails: scenes whose results lie beside those of the page, each calibrated and
judged by itself."""

from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, number, paragraph, section
from tipoff.studies.render.markup import table as drawn

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

HEADS = (
    "scene",
    "elements",
    "model",
    "judged",
    "agree",
    "largest rate L2 (%)",
    "largest settled error (deg/s)",
    "reference not converged",
)


def draw(page: "Page") -> Html:
    """The section, where other scenes have results beside these."""
    found = page.documents.get("rails")
    return section("rails", "Other rails", table(found)) if found else Html("")


def rows(found: list[dict]) -> list[tuple]:
    """Two rows a scene, calibrated springs and compliant contact, over its conditions with a touch:
    how many are judged, because their reference is converged, how many of those agree, the largest
    errors of these, and how many are not judged."""
    return [
        (
            scene["name"],
            f"{1e3 * scene['element_size_m']:g} mm",
            title,
            *_judged(scene["agreement"], kinds),
        )
        for scene in found
        for title, kinds in (
            ("springs, calibrated", ("fitted", "held_out")),
            ("compliant", ("compliant",)),
        )
    ]


def _judged(agreement: dict, kinds: tuple[str, ...]) -> tuple:
    touched = [row for kind in kinds for row in agreement[kind] if row["touches"]]
    judged = [row for row in touched if row["reference_converged"]]
    errors = [
        100.0 * row["rate_relative_l2"] for row in judged if row["rate_relative_l2"] is not None
    ]
    settled = [
        row["settled_rate_error_deg_s"]
        for row in judged
        if row["settled_rate_error_deg_s"] is not None
    ]
    return (
        f"{len(judged)} of {len(touched)}",
        str(sum(row["passes"] for row in judged)),
        number(max(errors, default=None), 2),
        number(max(settled, default=None), 2),
        ", ".join(row["condition"] for row in touched if not row["reference_converged"]),
    )


def constants(found: list[dict]) -> list[tuple]:
    """What each scene was calibrated to."""
    return [
        (
            scene["name"],
            ", ".join(
                f"{key.removeprefix('contact.')} {value:.4g}"
                for key, value in scene["constants"].items()
            ),
        )
        for scene in found
    ]


def table(found: list[dict]) -> Html:
    """Both tables, and what makes more of them."""
    return Html(
        "".join(
            [
                paragraph(
                    "Scenes whose results lie beside these. Springs were calibrated anew for each; "
                    "the compliance is from statics."
                ),
                drawn(HEADS, rows(found)),
                drawn(("scene", "calibrated constants (SI)"), constants(found)),
                caption(
                    "Of the conditions in which a pad touches a rail, those are judged whose "
                    "reference is converged. "
                    "make rails calibrates and judges the catalogue's thin and titanium rails at 4 "
                    "mm."
                ),
            ]
        )
    )
