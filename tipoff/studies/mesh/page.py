"""The mesh on the page."""

import base64
from html import escape
from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, section, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""
    found = page.documents.get("mesh")
    if not found:
        return section("mesh", "Mesh", page.missing("mesh", "mesh"))
    path = page.folder / found["picture"]
    image = base64.b64encode(path.read_bytes()).decode()
    areas = [
        (name.replace("_", " "), item["facets"], f"{1e6 * item['area_m2']:.5g}")
        for name, item in found["surfaces"].items()
    ]
    words = (
        f"{found['elements']:,} {found['kind']}, {found['nodes']:,} nodes, elements of about "
        f"{1e3 * found['element_size_m']:g} mm; edges {1e3 * found['shortest_edge_m']:.3g} to "
        f"{1e3 * found['longest_edge_m']:.3g} mm, smallest scaled Jacobian "
        f"{found['smallest_scaled_jacobian']:.3f} (1 for "
        "a brick and for a regular tetrahedron)."
    )
    warned = "".join(f'<div class="notice">{escape(line)}</div>' for line in found["warnings"])
    return section(
        "mesh",
        "Mesh",
        Html(f'<img alt="mesh of the rails" src="data:image/png;base64,{image}">'),
        caption(words),
        table(("surface", "facets", "area (mm²)"), areas),
        warned,
    )
