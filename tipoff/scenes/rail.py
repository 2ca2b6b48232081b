"""``[rail]``: the built-in L section, any other section, a mesh of the user, or a solid of the user,
meshed here.

The key ``mesh`` or ``geometry`` selects a file. A file is in scene axes (m, origin at the nominal
mass centre at ignition, +X to the open end); keys say how a mesh differs from that. Its walls are one
``clearance`` off the pads. The surrogate does not use the file: ``start`` and ``end`` give the ends
of the walls, pads and clearance their distance. The reference refuses a file that differs from them
(``highfi.rail.fit``).
Any kind of rail may have a ``damping`` (``scenes.effects.structural_damping``), for the reference
and the modes of compliant contact, and a ``mount_stiffness`` (``scenes.effects.mount_stiffness``);
without it the mounts are rigid.
"""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tipoff.files import open_input
from tipoff.formats.meshes import lsdyna_includes
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.rail_base import DrawnTable, HeldBySpans
from tipoff.scenes.rounding import at_most, below
from tipoff.scenes.table import at_least_one, is_absent, limited
from tipoff.scenes.tables import BoxTable
from tipoff.scenes.units import SMALLEST_DIMENSION, Dimension, Length

LARGEST_FILLET = 1.25  # of the thickness: the mesh has no good elements around a larger one
FILES = ("mesh", "geometry", "section")  # keys that give the rail as a file or a drawing
SOLIDS = (".step", ".stp", ".iges", ".igs", ".brep")


class SectionTable(HeldBySpans):
    """Built-in L sections from ``start`` to ``end`` along X, held by the platform at
    ``mounts``."""

    GIVEN_BY = "l_section"
    #: Outer width of a leg of the L.
    leg: Dimension = 0.024
    #: Thickness of a leg.
    thickness: Dimension = 0.004
    #: Width of the strip on the back of a leg that the platform holds, from the outer corner.
    mount_width: Dimension = 0.004
    #: Radius of the fillet between the inner walls, at most 1.25 times the thickness; a sharp
    #: corner where absent. The walls end where the fillet begins.
    fillet: Dimension | None = Field(None, exclude_if=is_absent)

    @field_validator("thickness", "mount_width")
    @classmethod
    def _within_leg(cls, value: float, info: ValidationInfo):
        leg = info.data.get("leg", math.inf)
        free = SMALLEST_DIMENSION if info.field_name == "thickness" else 0.0
        if below(leg - free, value, leg if math.isfinite(leg) else 0.0):
            raise ValueError(f"less than the leg, {leg:g} m")
        return value

    @field_validator("fillet")
    @classmethod
    def _beside_walls(cls, value: float | None, info: ValidationInfo):
        if value is None or not {"leg", "thickness"} <= info.data.keys():
            return value
        leg, thickness = info.data["leg"], info.data["thickness"]
        if not at_most(value, largest := LARGEST_FILLET * thickness):
            raise ValueError(f"at most {LARGEST_FILLET:g} times the thickness, {largest:g} m")
        if below(leg - SMALLEST_DIMENSION, thickness + value, leg):
            raise ValueError(f"less than the inside of the leg, {leg - thickness:g} m")
        return value


class _FileTable(DrawnTable):
    """A rail given by a file."""

    _digest: str = PrivateAttr()

    @model_validator(mode="after")
    def _taken(self):
        self._digest = self._digest_now()
        return self

    def _digest_now(self) -> str:
        return lsdyna_includes.digest(self.path())

    def is_as_found(self) -> bool:
        """Whether the file and those that it includes have not changed since the scene was read."""
        return self._digest_now() == self._digest

    def path(self) -> Path:
        """Path of the file."""
        return Path(getattr(self, self.GIVEN_BY))

    def contents(self) -> dict[str, str]:
        """The digest of the file, with those that it includes, at the time the scene was read."""
        return {self.GIVEN_BY: self._digest}


def _readable(file: str) -> str:
    try:
        if Path(file).suffix.lower() in lsdyna_includes.SUFFIXES:
            lsdyna_includes.pieces(Path(file))
        with open_input(file) as stream:
            stream.read(1)
    except OSError as error:
        raise ValueError(f"a readable file ({error.strerror})") from error
    return file


_Boxes = Annotated[tuple[BoxTable, ...], limited, AfterValidator(at_least_one)]
_Names = Annotated[tuple[str, ...], limited, AfterValidator(at_least_one)]


def _wrong_names(surfaces: Iterable[str]) -> list[str]:
    """Names that are neither a wall nor the mount."""
    return [
        f"a name that starts with 'contact' or is 'mount' instead of {name!r}"
        for name in surfaces
        if not name.startswith("contact") and name != "mount"
    ]


_Axis = Literal["x", "y", "z", "-x", "-y", "-z"]


class MeshTable(_FileTable):
    """``[rail] mesh``: hexahedra or tetrahedra in a file of a mesh generator, with surfaces
    ``contact...`` and ``mount`` (``highfi.mesh.rail_mesh``): groups of the file with these names,
    other ``groups``, or boxes in ``surfaces``.

    Without ``unit``, ``axes`` and ``origin`` the file is in metres and in scene axes.
    """

    GIVEN_BY = "mesh"
    #: Mesh file of gmsh, Abaqus, CalculiX, Nastran, LS-DYNA, Salome or VTK.
    mesh: Annotated[str, AfterValidator(_readable)]
    #: Unit of the lengths in the file: m, cm, mm, in or ft; metres where absent.
    unit: Literal["m", "cm", "mm", "in", "ft"] | None = Field(None, exclude_if=is_absent)
    #: Axes of the file that point along X, Y and Z of the scene, such as ["z", "-y", "x"].
    axes: tuple[_Axis, _Axis, _Axis] | None = Field(None, exclude_if=is_absent)
    #: Place of the origin of the scene, along the axes of the file.
    origin: tuple[Length, Length, Length] | None = Field(None, exclude_if=is_absent)
    #: Group of solids to use, where the file has other bodies too.
    body: str | None = Field(None, exclude_if=is_absent)
    #: Groups of the file, by the wall (a name that starts with contact) or mount that they are.
    groups: Annotated[dict[str, _Names], limited] | None = Field(None, exclude_if=is_absent)
    #: Boxes in scene axes that contain the walls (names that start with contact) and the clamped
    #: surface (mount).
    surfaces: Annotated[dict[str, _Boxes], limited] | None = Field(None, exclude_if=is_absent)

    @field_validator("axes")
    @classmethod
    def _right_handed(cls, axes: tuple[str, str, str] | None):
        if axes is not None and not math.isclose(determinant(axes), 1.0):
            raise ValueError(
                'three different axes that are right-handed, such as ["y", "z", "x"]; others '
                "would give the mirror image of the rail"
            )
        return axes

    @field_validator("groups", "surfaces")
    @classmethod
    def _walls_or_mount(cls, surfaces):
        if wrong := _wrong_names(surfaces or ()):
            raise ValueError("; ".join(wrong))
        return surfaces


def directions(axes: tuple[str, str, str]) -> tuple[tuple[float, ...], ...]:
    """Unit vectors in the axes of a file along X, Y and Z of the scene."""
    return tuple(
        tuple((-1.0 if axis[0] == "-" else 1.0) * (axis[-1] == own) for own in "xyz")
        for axis in axes
    )


def determinant(axes: tuple[str, str, str]) -> float:
    """1 for right-handed axes, -1 for left-handed ones, 0 if two of them are parallel."""
    (a, b, c), (d, e, f), (g, h, i) = directions(axes)
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


class GeometryTable(_FileTable):
    """``[rail] geometry``: a solid drawn in CAD, meshed here with ``elements`` of 8-node hexahedra
    or 10-node tetrahedra. ``surfaces`` names the parts of its boundary that lie in boxes."""

    GIVEN_BY = "geometry"
    #: CAD solid: STEP, IGES or BREP, in scene axes.
    geometry: Annotated[str, AfterValidator(_readable)]
    #: 8-node hexahedra or 10-node tetrahedra.
    elements: Literal["hex8", "tet10"] = "hex8"
    #: Boxes that contain the walls (names that start with contact) and the clamped surface
    #: (mount).
    surfaces: Annotated[dict[str, _Boxes], limited]

    def libraries(self) -> tuple[str, ...]:
        """The mesh generator."""
        return ("gmsh",)

    @field_validator("geometry")
    @classmethod
    def _drawn(cls, file: str):
        if Path(file).suffix.lower() not in SOLIDS:
            raise ValueError(f"a file that ends in one of {', '.join(SOLIDS)}")
        return file

    @field_validator("surfaces")
    @classmethod
    def _walls_and_mount(cls, surfaces):
        wrong = _wrong_names(surfaces)
        if not any(name.startswith("contact") for name in surfaces):
            wrong.append("a surface whose name starts with 'contact'")
        if "mount" not in surfaces:
            wrong.append("a surface 'mount'")
        if wrong:
            raise ValueError("; ".join(wrong))
        return surfaces


def _given_by(rail: Any) -> str:
    if isinstance(rail, dict):
        return next((key for key in FILES if key in rail), SectionTable.GIVEN_BY)
    return getattr(rail, "GIVEN_BY", SectionTable.GIVEN_BY)


RailTable = Annotated[
    Annotated[SectionTable, Tag("l_section")]
    | Annotated[ProfileTable, Tag("section")]
    | Annotated[MeshTable, Tag("mesh")]
    | Annotated[GeometryTable, Tag("geometry")],
    Discriminator(_given_by),
]
