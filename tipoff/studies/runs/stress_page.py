"""Stress of the rails on the page: peaks of every condition beside the yield strength, what is
doubtful about them, pictures."""

import base64
import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, code, number, paragraph, section, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_MIME = {".png": "image/png", ".webp": "image/webp"}


def draw(page: "Page") -> Html:
    """Peak stresses of all conditions, and pictures of those that `make view` was made for."""
    rows = page.rows()["highfi"]
    if not rows:
        return section("stress", "Stress of the rails", page.missing("highfi", "highfi"))
    return shown(rows, page.documents.get("view") or [], page.folder, page.scene.name)


def shown(rows: list[dict], views: list[dict], folder: Path, scene: str) -> Html:
    """The section: ``rows`` of highfi.json, ``views`` results of the stage ``view``, whose files
    lie below ``folder``."""
    heads = (
        "condition",
        "peak von Mises (MPa)",
        "of yield (%)",
        "x, y, z (mm)",
        "rail",
        "at (ms)",
        "largest strain (%)",
        "largest rotation (deg)",
    )
    known = [row for row in rows if row.get("peak_stress_pa") is not None]
    if not known:
        return section(
            "stress",
            "Stress of the rails",
            paragraph("No run of the reference says what its rails bear."),
        )
    warned = "".join(
        f'<div class="notice">{escape(row["condition"])}: {escape(words)}</div>'
        for row in known
        for words in row["warnings"]
    )
    strengths = {row["yield_strength_pa"] for row in known} - {None}
    strength = (
        ", ".join(f"{1e-6 * value:g} MPa" for value in sorted(strengths))
        or "not stated by the scene"
    )
    words = (
        f"Largest von Mises stress at any node of any element, not averaged. Yield strength: "
        f"{strength}. At a sharp "
        "inner corner or the border of a clamp the stress of linear elasticity has no limit, so "
        "the peak grows with every "
        "finer mesh; the convergence study judges stress by its mean over patches of 4 mm instead. "
        "Rails are elastic, strains and rotations small."
    )
    return section(
        "stress",
        "Stress of the rails",
        warned,
        table(heads, [_row(row) for row in known], dense=True),
        caption(words),
        *(_pictures(view, folder) for view in views),
        Html("") if views else _how(scene),
    )


def _row(row: dict) -> tuple:
    strength = row["yield_strength_pa"]
    share = None if strength is None else number(100.0 * row["peak_stress_pa"] / strength)
    return (
        row["condition"],
        number(1e-6 * row["peak_stress_pa"], 4),
        share,
        ", ".join(f"{1e3 * value:.5g}" for value in row["peak_stress_place_m"]),
        row["peak_stress_rail"],
        f"{1e3 * row['peak_stress_time_s']:.4g}",
        number(100.0 * row["largest_strain"], 2),
        number(math.degrees(row["largest_rotation_rad"]), 2),
    )


def _pictures(view: dict, folder: Path) -> Html:
    """What one condition looks like, or what would make pictures of it."""
    files = paragraph(
        f"Condition {view['condition']}: {len(view['frames'])} frames for ParaView in ",
        code(view["collection"]),
        ". ",
        view["without_pictures"],
    )
    if not view["pictures"]:
        return files
    words = (
        f"Condition {view['condition']}, elements of {1e3 * view['element_size_m']:g} mm, seen "
        f"from the platform. The rails "
        f"are drawn with {view['factor']:g} times their deformation, payload and pads to scale, so "
        f"pads seem to enter a rail "
        "they only press. Above, the worst moment; below, the ejection."
    )
    images = "".join(
        f'<p><img alt="{name} of {escape(view["condition"])}" src="{_embedded(folder / path)}"></p>'
        for name, path in sorted(view["pictures"].items(), key=lambda item: item[0] != "peak")
    )
    return Html(files + images + caption(words))


def _embedded(path: Path) -> str:
    return f"data:{_MIME[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode()}"


def _how(scene: str) -> Html:
    adds, draws = code(f"make view SCENE={scene}"), code("make pictures")
    return Html(
        f'<p class="caption">{adds} adds files for ParaView, and pictures after {draws}.</p>'
    )
