"""The results file of Adams, ``.res`` in XML.

``StepMap`` lists the entities with their components, each with its unit and the place ``id`` (from 1) of
its value in a step. Each ``Step`` has the values of all components at one time. A part has the entity
``NAME_XFORM`` with the components X, VX, WX ...; the entity ``time`` has TIME.
"""

import io
import re
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.formats.curves.record import (
    HEAD,
    Asked,
    CurveFile,
    CurveFormat,
    CurveTable,
    chosen_body,
)

_MARK = re.compile(rb"<Results[\s>]")
_TIME = "time.TIME"
_XFORM = "_XFORM"
_INPUT, _INITIAL = "input", "initialConditions"
_MOST_COMPONENTS = 1_000_000
_COMPONENTS = {"velocity_x": "VX", "rate_x": "WX", "rate_y": "WY", "rate_z": "WZ"}


class _Component(NamedTuple):
    entity: str
    name: str
    unit: str | None
    place: int  # from 1


def read_adams(file: CurveFile, asked: Asked) -> CurveTable:
    """The components ``ENTITY.NAME`` that are ``asked``, with their units; by default those of one part.
    Raises SceneError."""
    source, data, body = file.source, file.data, asked.body
    wanted = [*asked.unsigned(), *asked.columns]
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:  # entities may expand without end
        raise SceneError([Fault(source, "file", "a DOCTYPE", "XML without one, as of Adams")])
    try:
        return _read(source, data, body, wanted)
    except SceneError:
        raise
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise SceneError([Fault(source, "file", str(error), "XML of Adams results")]) from None


def _read(source: str, data: bytes, body: str | None, wanted: list[str]) -> CurveTable:
    components: list[_Component] = []
    kept: dict[str, _Component] = {}
    columns: dict[str, str] = {"time": _TIME}
    rows: list[list[float]] = []
    entity, has_initial = "", False
    for event, item in ElementTree.iterparse(io.BytesIO(data), ("start", "end")):
        tag = item.tag.rpartition("}")[2]
        if event == "start" and tag == "Entity":
            entity = item.get("name", "")
        elif event == "end" and tag == "Component":
            components.append(_component(source, entity, item))
            if len(components) > _MOST_COMPONENTS:
                raise SceneError([Fault(source, "file", "more components", "a million at most")])
        elif event == "end" and tag == "StepMap":
            columns |= _of_part(source, components, body, wanted)
            kept = _kept(components, {*columns.values(), *wanted})
        elif event == "end" and tag == "Step":
            kind = item.get("type", "")
            if (kind == _INITIAL and has_initial) or kind == _INPUT:
                item.clear()
                continue
            has_initial |= kind == _INITIAL
            rows.append(_values(source, item.text or "", list(kept.values())))
        if event == "end" and tag in ("Step", "Entity"):
            item.clear()
    names = [f"{one.entity}.{one.name}" for one in components]
    ordered = [*kept, *(name for name in dict.fromkeys(names) if name not in kept)]
    if _TIME in kept and len(rows) > 1:
        place = list(kept).index(_TIME)
        if rows[0][place] == rows[1][place]:  # the first step repeats the initial conditions
            del rows[0]
    table = np.full((len(rows), len(ordered)), np.nan)
    table[:, : len(kept)] = np.array(rows).reshape(len(rows), len(kept))
    units = {f"{one.entity}.{one.name}": one.unit for one in components}
    return CurveTable(ordered, [units[name] for name in ordered], table, columns, axes=None)


def _component(source: str, entity: str, item: ElementTree.Element) -> _Component:
    text = item.get("id", "")
    if not (text.isdecimal() and 0 < len(text) < 8 and int(text) > 0):
        raise SceneError([Fault(source, "id", f"{text[:20]!r}", "the place of each component")])
    unit = item.get("unitsValue")
    return _Component(entity, item.get("name", ""), unit, int(text))


def _kept(components: list[_Component], names: set[str]) -> dict[str, _Component]:
    found = {f"{one.entity}.{one.name}": one for one in components}
    return {name: one for name, one in found.items() if name in names}


def _of_part(
    source: str, components: list[_Component], body: str | None, wanted: list[str]
) -> dict[str, str]:
    """Default columns: those of a part, unless --columns names others and no part."""
    parts = [one.entity for one in components if one.name == _COMPONENTS["rate_x"]]
    if body is None and wanted:
        return {}
    found = {name.removesuffix(_XFORM): name for name in dict.fromkeys(parts)}
    part = found[chosen_body(source, body, list(found))]
    return {name: f"{part}.{component}" for name, component in _COMPONENTS.items()}


def _values(source: str, text: str, kept: list[_Component]) -> list[float]:
    cells = text.split()
    try:
        return [float(cells[one.place - 1]) for one in kept]
    except IndexError:
        given = f"a step of {len(cells)} values"
        raise SceneError([Fault(source, "Step", given, "one for each component")]) from None
    except ValueError as error:
        raise SceneError([Fault(source, "Step", str(error)[:80], "numbers")]) from None


def _is_adams(data: bytes) -> bool:
    return _MARK.search(data, 0, HEAD) is not None


FORMATS = (
    CurveFormat(
        "results of Adams (.res)",
        read_adams,
        [
            (
                "Adams results `.res`, XML",
                "components `ENTITY.NAME`, such as `time.TIME` and `PART_2_XFORM.WX`",
                "name of the part",
                "in the file",
                "`--axes` must state them",
            )
        ],
        is_in=_is_adams,
    ),
)
