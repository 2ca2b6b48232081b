"""Fast variations of one scene: only the changes of a row of overrides are validated again.

``Variations.of`` returns the same tables as ``Scene.replace``. The first row with certain keys is
validated by tables. Later rows with the same keys are validated by single numbers, unless a rule of
a table depends on several of them. A row with a fault goes through ``replace``, so that the faults
are the same too.
"""

import copy
from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from tipoff.scenes import overrides as keys
from tipoff.scenes import unchanged
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.scenes.parts import expansion
from tipoff.scenes.scene import Scene
from tipoff.scenes.table import Table

_TABLES = {
    "payload",
    "buttons",
    "lugs",
    "deployer",
    "pads",
    "rail",
    "thrust",
    "output",
    *(effect.key for effect in EFFECTS if "." not in effect.key),
}
_FREE = {"thrust_offset", "mass_offset", "initial"}  # no part reads or writes them
_CONTEXT = {"bare_numbers_are_si": True}


class _Leaf(NamedTuple):
    """A number of a scene that is overwritten."""

    values: dict  # its table
    raw: dict  # the same table as written
    name: str
    adapter: TypeAdapter  # its validator


class Variations:
    """Variations of ``scene``."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self._expanded = expansion.expand(scene._raw, True).tables
        self._adapters: dict[Any, TypeAdapter] = {}
        self._prepared: dict[tuple, tuple[Scene, list[_Leaf]] | None] = {}

    def of(self, row: Mapping[str, Any]) -> Scene:
        """The scene with the overrides of ``row``. It is overwritten by the next call. Raises
        SceneError as ``Scene.replace`` does."""
        names = tuple(row)
        if (prepared := self._prepared.get(names)) is None:
            scene = self._by_tables(row)
            if names not in self._prepared:
                own = self._copy(row)
                self._prepared[names] = self._leaves(names, own) if own else None
            return scene
        scene, leaves = prepared
        try:
            values = [
                leaf.adapter.validate_python(value, context=_CONTEXT)
                for leaf, value in zip(leaves, row.values())
            ]
        except ValidationError:
            return self.scene.replace(row)
        for leaf, value in zip(leaves, values):
            leaf.values[leaf.name] = leaf.raw[leaf.name] = value
        return scene if scene.agrees() else self.scene.replace(row)

    def kept(self, scene: Scene) -> Scene:
        """A copy of a result of ``of`` that later calls do not overwrite. It has the tables of the
        base scene that are unchanged themselves: to copy them takes longer than a run."""
        changed = {
            name: copy.deepcopy(getattr(scene, name))
            for name in Scene.model_fields
            if getattr(scene, name) is not getattr(self.scene, name)
        }
        found = scene.model_copy(update=changed)
        own = {name: keys.plain(raw) for name, raw in scene._raw.items() if name in changed}
        found._raw = scene._raw | own
        return found

    def _by_tables(self, row: Mapping[str, Any]) -> Scene:
        return self._copy(row) or self.scene.replace(row)

    def _copy(self, row: Mapping[str, Any]) -> Scene | None:
        """A copy of the scene with the tables that ``row`` changes; None if ``replace`` must
        validate the whole scene."""
        changed = dict.fromkeys(key.partition(".")[0] for key in row)
        if not changed.keys() <= _TABLES:
            return None
        with_parts = expansion.has_parts(self.scene._raw)
        raw = {
            name: keys.plain(table)
            for name, table in self.scene._raw.items()
            if with_parts or name in changed
        }
        if ("pads" in changed and expansion.gives_pads(self.scene._raw)) or keys.apply_all(
            raw, row, Scene
        ):
            return None
        expanded = raw
        if with_parts:
            after = expansion.expand(raw, True)
            if after.faults:
                return None
            expanded = after.tables
            changed |= dict.fromkeys(
                name for name in _TABLES if expanded.get(name) != self._expanded.get(name)
            )
        try:
            tables = {name: self._table(name, expanded) for name in changed}
        except (ValidationError, KeyError):
            return None
        found = self.scene.model_copy(update=tables)
        if not found.agrees():
            return None
        base = self.scene
        unchanged.require((base.thrust, base.rail), (found.thrust, found.rail), base.name)
        kept = {name: table for name, table in self.scene._raw.items() if name not in changed}
        found._raw = kept | raw
        return found

    def _table(self, name: str, raw: dict) -> Any:
        field = Scene.model_fields[name]
        if name not in raw and not field.is_required():
            return field.get_default()
        return self._adapter((Scene, name), field).validate_python(raw[name], context=_CONTEXT)

    def _adapter(self, key: tuple, field: FieldInfo) -> TypeAdapter:
        if key not in self._adapters:
            kind: Any = (
                Annotated[(field.annotation, *field.metadata)]
                if field.metadata
                else field.annotation
            )
            self._adapters[key] = TypeAdapter(kind)
        return self._adapters[key]

    def _leaves(self, names: tuple[str, ...], scene: Scene) -> tuple[Scene, list[_Leaf]] | None:
        """``scene``, a copy to be overwritten, and its numbers under ``names``; None if one of them
        is not a free number."""
        if expansion.has_parts(scene._raw) and not _FREE.issuperset(
            name.partition(".")[0] for name in names
        ):
            return None
        leaves = []
        for name in names:
            *path, last = name.split(".")
            table: Any = scene
            written: Any = scene._raw
            for part in path:
                written = written.get(part) if isinstance(written, dict) else None
                table = (
                    table.__dict__.get(part)
                    if isinstance(table, Table) and _free(type(table), table is scene)
                    else None
                )
            if not (
                isinstance(table, Table)
                and table is not scene
                and _free(type(table))
                and isinstance(getattr(table, last, None), float)
                and isinstance(written, dict)
            ):
                return None
            leaves.append(
                _Leaf(
                    table.__dict__,
                    written,
                    last,
                    self._adapter((type(table), last), type(table).model_fields[last]),
                )
            )
        return scene, leaves


def _free(kind: type[Table], whole: bool = False) -> bool:
    """Whether a table of this kind has no rule on its values, except that it must not be empty."""
    rules = kind.__pydantic_decorators__
    return whole or (not rules.field_validators and set(rules.model_validators) <= {"_not_empty"})
