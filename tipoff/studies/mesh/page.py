"""The mesh of the rails."""

from collections.abc import Callable

from tipoff.studies.mesh.stage import Deck, Mesh
from tipoff.studies.render.document import Caption, Notice, Part
from tipoff.studies.render.table import Column, Table


def draw(found: Mesh) -> list[Part]:
    """The mesh; its named surfaces: their facets, their area, and for a solid the area of its own
    faces; then the extent of the rails."""
    surfaces = found.surfaces
    columns: list[tuple[Column | str, Callable]] = [
        ("surface", lambda item: item[0].replace("_", " ")),
        ("facets", lambda item: item[1].facets),
        (Column("area", "mm²", ".5g", 1e6), lambda item: item[1].area_m2),
    ]
    if all(item.drawn_area_m2 is not None for item in surfaces.values()):
        drawn = Column("area in the drawing", "mm²", ".5g", 1e6)
        columns.append((drawn, lambda item: item[1].drawn_area_m2))
    spans = ", ".join(
        f"{axis} {1e3 * low:.6g} to {1e3 * high:.6g} mm"
        for axis, low, high in zip("xyz", found.low_m, found.high_m)
    )
    return [
        Caption(
            f"{found.elements:,} {found.kind}, {found.nodes:,} nodes, elements of about "
            f"{1e3 * found.element_size_m:g} mm. Edges: {1e3 * found.shortest_edge_m:.3g} to "
            f"{1e3 * found.longest_edge_m:.3g} mm. Smallest scaled Jacobian: "
            f"{found.smallest_scaled_jacobian:.3f} (1 for a brick and for a regular "
            f"tetrahedron). ParaView shows {found.mesh}."
        ),
        Table.of(surfaces.items(), columns),
        Caption(f"Rails in scene axes: {spans}."),
        *([Caption(_deck(found.deck))] if found.deck else []),
        *map(Notice, found.warnings),
    ]


def _deck(deck: Deck) -> str:
    """What the file for other codes has, and the answers to expect."""
    frequencies = ", ".join(f"{value:.5g}" for value in deck.frequencies_hz)
    return (
        f"{deck.file}: the first rail for CalculiX and Abaqus, with {deck.force_n:g} N under the first "
        f"pad. Deflection here {1e6 * deck.deflection_m:.5g} µm, lowest frequencies {frequencies} Hz."
    )
