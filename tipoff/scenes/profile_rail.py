"""``[rail] section``: an extruded rail of any section, given by corners, by a drawing (DXF), by an
extruded solid (STEP), or by a few numbers.

The section stands across X with its origin at ``at``. Its walls are found: every side that faces a
pad at the clearance for which the section is drawn. The platform holds the sides at the points
``mounted``, on the stretches ``mounts``.
"""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, PrivateAttr, Tag
from pydantic import model_validator as model

from tipoff.faults import close
from tipoff.files import content_hash
from tipoff.formats.outline import Loop, Outline, outline
from tipoff.formats.sections.reader import read_section
from tipoff.scenes.faults import within
from tipoff.scenes.rail_base import DrawnTable, HeldBySpans
from tipoff.scenes.section_shapes import SHAPES, ShapeTable
from tipoff.scenes.table import at_least_one, is_absent, limited
from tipoff.scenes.units import Length, quantity

_Point = tuple[Length, Length]
_Points = Annotated[tuple[_Point, ...], limited]


def _one_of_three(section: Any) -> Any:
    is_shape = isinstance(section, dict) and section.get("shape") in SHAPES
    if is_shape or isinstance(section, (str, list, tuple)) or hasattr(section, "shape"):
        return section
    given = str(section.get("shape", "")) if isinstance(section, dict) else ""
    raise ValueError(
        'corners such as [["0 mm", "0 mm"], ["24 mm", "0 mm"], ...], a DXF or STEP file, or a table whose '
        f"shape is one of {', '.join(SHAPES)}{close(given, SHAPES)}"
    )


def _kind(section: Any) -> str:
    if isinstance(section, str):
        return "file"
    return "points" if isinstance(section, (list, tuple)) else "shape"


class ProfileTable(HeldBySpans, DrawnTable):
    """``[rail] section``: a rail of one section from ``start`` to ``end`` along X, meshed here in
    hexahedra."""

    GIVEN_BY = "section"
    #: Section across the rail: corners along Y and Z, in order; a DXF file with closed loops; a STEP
    #: file with an extruded solid; or a table with a shape.
    section: Annotated[
        Annotated[str, Tag("file")]
        | Annotated[_Points, Tag("points")]
        | Annotated[ShapeTable, Tag("shape")],
        Discriminator(_kind),
        BeforeValidator(_one_of_three),
    ]
    #: Unit of the lengths of a DXF or STEP file: m, cm, mm, in or ft; the one that the file states
    #: where absent.
    unit: Literal["m", "cm", "mm", "in", "ft"] | None = Field(None, exclude_if=is_absent)
    #: Place of the origin of the section in the scene, along Y and Z.
    at: _Point = (0.0, 0.0)
    #: Further rails that are mirror images: across the plane y = 0, z = 0, or both.
    mirrored: Annotated[tuple[Literal["y", "z"], ...], Field(max_length=2)] = ()
    #: One point on each side of the section that the platform holds, in the axes of the section.
    mounted: Annotated[_Points, AfterValidator(at_least_one)]
    #: Length of the elements along the rail, as a multiple of the element size.
    stretch: quantity("dimensionless", ge=1.0, le=20.0) = 1.0  # type: ignore[valid-type]
    _outline: Outline = PrivateAttr()
    _solid_length: float | None = PrivateAttr(None)

    @model(mode="after")
    def _drawn(self):
        try:
            self._outline = self._read()
        except (ValueError, OSError) as fault:
            words = (
                f"a readable file ({fault.strerror})" if isinstance(fault, OSError) else str(fault)
            )
            raise within("section", _shown(self.section), words) from fault
        for place, point in enumerate(self.mounted):
            try:
                self._outline.side_at(point)
            except ValueError as fault:
                given = f"({1e3 * point[0]:.6g}, {1e3 * point[1]:.6g}) mm"
                raise within(f"mounted.{place}", given, str(fault)) from fault
        if self.unit is not None and not isinstance(self.section, str):
            raise within("unit", repr(self.unit), "no such key, other than with a file")
        return self

    def _read(self) -> Outline:
        if isinstance(self.section, str):
            found = read_section(self.section, self.unit)
            self._solid_length = found.length
            return outline(found.loops)
        if isinstance(self.section, tuple):
            return outline([self.section])
        return self.section.outline()

    def outline(self) -> Outline:
        """The outline of the section in its own axes."""
        return self._outline

    def solid_length(self) -> float | None:
        """Length (m) of the solid whose section this is; None without a solid."""
        return self._solid_length

    def blocks(self) -> tuple[Loop, ...]:
        """Four corners (m) of each block that fills the section, in scene axes; none if they are not
        known."""
        found = () if isinstance(self.section, (str, tuple)) else self.section.blocks()
        return Outline(found).at(self.at).loops

    def signs(self) -> tuple[tuple[int, int], ...]:
        """Signs of Y and Z of each rail: the one drawn, and its mirror images."""
        across = [(1, -1) if axis in self.mirrored else (1,) for axis in ("y", "z")]
        return tuple((y, z) for y in across[0] for z in across[1])

    def images(self) -> list[Outline]:
        """The outline of each rail in scene axes; those of mirror images run the other way round."""
        placed = self._outline.at(self.at)
        return [placed.mirrored(*each) for each in self.signs()]

    def contents(self) -> dict[str, str]:
        """The digest of the outline of a file when the scene was read."""
        if not isinstance(self.section, str):
            return {}
        return {"section": content_hash(self._outline.loops)}

    def libraries(self) -> tuple[str, ...]:
        """The mesh generator."""
        return ("gmsh",)


def _shown(section: Any) -> str:
    if isinstance(section, str):
        return repr(section)
    return f"{len(section)} corners" if isinstance(section, tuple) else f"a {section.shape}"
