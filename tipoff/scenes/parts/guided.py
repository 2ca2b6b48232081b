"""What buttons and lugs have in common: tables, bands of faces, play, and what a material gives."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import TypeAdapter, ValidationError

from tipoff.scenes.parts.made import Made
from tipoff.scenes.parts.profiles import FRICTION, MATERIALS

FILES = ("mesh", "geometry", "section")  # of [rail], in place of the section of a part
Faults = list[tuple[str, str, str]]


def tables(made: Made, name: str, adapter: TypeAdapter) -> Sequence[Any]:
    """The tables of the part ``name``; none if they are refused, here or by the scene."""
    if "pads" in made.raw:
        made.refuse("pads", "a table", f"none beside {name}, which are pads; or no {name}")
        return ()
    made.derived["pads"] = ""
    try:
        context = {"bare_numbers_are_si": made.bare}
        found = adapter.validate_python(made.tables[name], context=context)
    except ValidationError:  # the scene has the same faults
        return ()
    if not found:
        made.refuse(name, "none", "at least one of them")
    return found


def with_first(own: Any, first: Any, groups: Iterable[Sequence[str]]) -> dict[str, Any]:
    """The keys of a table, with those of the ``first`` one for each of the ``groups`` of which it states
    none."""
    found = {name: getattr(own, name) for name in type(own).model_fields}
    for names in groups:
        if all(found[name] is None for name in names):
            found |= {name: getattr(first, name) for name in names}
    return found


def unequal(key: str, own: Any, first: Any, names: Iterable[str]) -> Faults:
    """The faults of a part that differs from the ``first`` one in a length (m) that the rail gives to all."""
    return [
        (
            f"{key}.{name}",
            f"{getattr(own, name):g} m",
            f"{getattr(first, name):g} m, that of the first one: one rail holds all",
        )
        for name in names
        if abs(getattr(own, name) - getattr(first, name)) > 1e-9
    ]


def bands(place: float, length: float, longest: float) -> list[tuple[float, float]]:
    """Middle and length (m) of the faces of a part with its middle at ``place``: one, or one at each end
    of a part of more than two of the ``longest``. A straight part touches a straight rail at its ends."""
    if length <= 2.0 * longest:
        return [(place, length)]
    reach = 0.5 * (length - longest)
    return [(place - reach, longest), (place + reach, longest)]


def slides(
    made: Made, play: Mapping[str, str], material: str | None, source: str, name: str
) -> None:
    """Play, contact of a ``material`` of the parts ``name``, and friction, where a scene with contact and
    friction does not state them."""
    contact = made.tables.get("contact")
    if isinstance(contact, dict) and "clearance" not in contact:
        made.put_absent("contact", play, source)
    if material is not None:
        made.put_absent("contact", MATERIALS[material], f"assumed: {name} of {material}")
    friction = made.tables.get("friction")
    if isinstance(friction, dict) and friction.get("law", "two-step") == "two-step":
        made.put_absent("friction", FRICTION, "assumed")


def rail(
    made: Made, missing: Mapping[str, Any], material: tuple[Mapping, str], source: str
) -> tuple[float, float, float] | None:
    """Give ``[rail]`` what it does not state: values ``missing`` that have a ``source``, and a ``material``
    with its own one. Returns the place (m) of its section along Y and Z, and its clearance (m); None for
    a value that the scene refuses."""
    table, (values, of_material) = made.tables["rail"], material
    made.put_absent("rail", missing, source)
    if "material" not in table:
        made.put("rail.material", dict(values), of_material)
    at, gap = table["at"], made.length(table["clearance"])
    if not isinstance(at, list) or len(at) != 2 or gap is None:
        return None
    y, z = map(made.length, at)
    return None if y is None or z is None else (y, z, gap)


def kind(section: Any) -> str:
    """What a section is, for a message."""
    return repr(section) if isinstance(section, str) else "no such section"
