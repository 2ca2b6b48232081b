"""The mesh on the page."""

from typing import TYPE_CHECKING

from tipoff.studies.render.document import Caption, Image, Notice, Part
from tipoff.studies.render.table import Column, Table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> list[Part]:
    """The picture of the mesh, its figures, and its surfaces."""
    found = page.documents.get("mesh")
    if not found:
        return [page.missing("mesh", "mesh")]
    return [
        Image(
            page.folder / found["picture"],
            "mesh of the rails",
            page.folder / found["dark_picture"],
        ),
        Caption(
            f"{found['elements']:,} {found['kind']}, {found['nodes']:,} nodes, elements of about "
            f"{1e3 * found['element_size_m']:g} mm. Edges: {1e3 * found['shortest_edge_m']:.3g} to "
            f"{1e3 * found['longest_edge_m']:.3g} mm. Smallest scaled Jacobian: "
            f"{found['smallest_scaled_jacobian']:.3f} (1 for a brick and for a regular "
            "tetrahedron)."
        ),
        surfaces(found),
        *map(Notice, found["warnings"]),
    ]


def surfaces(found: dict) -> Table:
    """The named surfaces: their facets, their area, and for a solid the area of its own faces."""
    columns: list[Column | str] = ["surface", "facets", Column("area", "mm²", ".5g", 1e6)]
    rows = [
        [name.replace("_", " "), item["facets"], item["area_m2"]]
        for name, item in found["surfaces"].items()
    ]
    drawn = [item["drawn_area_m2"] for item in found["surfaces"].values()]
    if None not in drawn:
        columns.append(Column("area in the drawing", "mm²", ".5g", 1e6))
        rows = [[*row, area] for row, area in zip(rows, drawn)]
    return Table(columns, rows)
