"""Reading scene files: TOML to one nested mapping. A file that ``extends`` another is merged over
it.

In such a file, a table set to ``"absent"`` drops the inherited one. A ``[thrust]`` of another kind,
a ``[contact]`` with another law and a ``[rail]`` from a file replace the inherited table. The
provenance of values in the file is "user" (``scenes.provenance``), unless its own ``[provenance]``
differs.
"""

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tipoff.faults import Fault, SceneError, close, kind_of
from tipoff.files import read_input
from tipoff.scenes import overrides, provenance, rail

FORMAT = 1  # of scene files; each states it under the key ``format``, or is read as this one
CATALOG = Path(__file__).resolve().parent / "catalog"
_CHOICE = {"thrust": "kind", "contact": "law", "section": "shape"}
# relative to the scene file; with a suffix if the value may also be a name of the catalogue
_FILES = (
    ("thrust", "file"),
    *(("rail", key) for key in rail.FILES),
    ("studies", "errors", ".toml"),
)
_FREE_TEXT = {"conditions", "provenance"}


def names() -> list[str]:
    """Names of the scenes that come with the package."""
    return sorted(path.stem for path in CATALOG.glob("*.toml"))


def read(name_or_path: str | Path) -> tuple[dict, str]:
    """Mapping and path of a catalogue scene (by name) or of a TOML file. Raises SceneError."""
    if not isinstance(name_or_path, (str, Path)):
        raise SceneError([Fault("arguments", "scene", kind_of(name_or_path), _known())])
    path = Path(name_or_path)
    if path.suffix != ".toml":
        if str(name_or_path) not in names():
            meant = close(str(name_or_path), names())
            raise SceneError(
                [Fault(str(name_or_path), "scene", "an unknown name", f"{_known()}{meant}")]
            )
        path = CATALOG / f"{name_or_path}.toml"
    raw = _inherit(path, str(path), ())
    raw.setdefault("name", path.stem)
    return raw, str(path)


def _known() -> str:
    return f"a path to a .toml file or one of {', '.join(names())}"


def _inherit(path: Path, user_file: str, chain: tuple[Path, ...]) -> dict:
    """``path`` merged over the file that it extends. A fault of an inherited file names this file
    and the file that the user gave."""
    key = "file" if not chain else "extends"
    if absolute(path) in chain:
        raise SceneError(
            [Fault(user_file, key, str(path), "files that do not extend each other in a circle")]
        )
    raw = of_this_format(toml(path, user_file, key), user_file, "" if not chain else f"{path}: ")
    for name, entry, *suffix in _FILES:
        for table in _with_springs(raw.get(name)):
            if (
                isinstance(table, dict)
                and isinstance(table.get(entry), str)
                and table[entry] != "absent"
                and table[entry].endswith(tuple(suffix) or "")
            ):
                table[entry] = str(absolute(path.parent / table[entry]))
    base = raw.pop("extends", None)
    if base is None:
        return raw
    if not isinstance(base, str) or (not base.endswith(".toml") and base not in names()):
        meant = close(str(base), names())
        raise SceneError([Fault(user_file, "extends", repr(base), f"{_known()}{meant}")])
    base_path = path.parent / base if base.endswith(".toml") else CATALOG / f"{base}.toml"
    inherited = _inherit(base_path, user_file, (*chain, absolute(path)))
    # results are filed by name, so a variation needs its own name
    inherited.pop("name", None)
    merged = _without_dropped(inherited, raw, _merged(inherited, raw))
    stated, given = (overrides.texts(table.get("provenance")) for table in (inherited, raw))
    if stated is not None and given is not None:
        merged["provenance"] = provenance.overridden(
            stated, merged, dict(_changes(inherited, raw)), given
        )
    return merged


def replaced_by_conditions(name_or_path: str | Path) -> list[str]:
    """Warnings: values of a file that extends another, if inherited conditions replace them.
    ``name_or_path``: of a scene that can be read."""
    path = Path(name_or_path)
    if path.suffix != ".toml":
        return []
    own = of_this_format(toml(path, str(path)), str(path))
    whole, stated = _inherit(path, str(path), ()), own.get("conditions", {})
    conditions = whole.get("conditions", {})
    inherited = {
        name: dict(overrides.dotted(table))
        for name, table in (conditions.items() if "extends" in own else ())
        if name not in stated
    }
    found = []
    for key, _ in overrides.dotted({**own, "conditions": {}}):
        names_ = [
            name
            for name, table in inherited.items()
            if any(f"{key}.".startswith(f"{changed}.") for changed in table)
        ]
        if names_:
            found.append(
                f"{path}: {key}: the inherited conditions {', '.join(names_)} replace this value; "
                f"state conditions of your own, or drop these with [conditions] {names_[0]} = "
                f'"absent"'
            )
    return found


def of_this_format(raw: Any, source: str, inherited: str = "") -> Any:
    """The tables of a scene without the number of their format. Raises SceneError for another number than
    ``FORMAT``, in place of the faults of its keys; ``inherited`` begins the given value."""
    if not isinstance(raw, Mapping) or "format" not in raw:
        return raw
    stated = raw["format"]
    if type(stated) is not int or stated != FORMAT:
        from importlib.metadata import version  # slow to load

        expected = (
            f"{FORMAT}, the format that tipoff {version('tipoff')} reads: install a version that reads "
            f"yours, or write format = {FORMAT} and change the keys that are then refused"
        )
        raise SceneError([Fault(source, "format", f"{inherited}{stated!r}", expected)])
    return {key: value for key, value in raw.items() if key != "format"}


def toml(path: Path, user_file: str, key: str = "file") -> dict:
    """Content of a TOML file. Raises SceneError under ``key`` of the file that the user gave."""
    inherited = "" if key == "file" else f"{path}: "
    try:
        # Editors may put a byte-order mark in front of UTF-8. "utf-8-sig" removes it.
        found = tomllib.loads(read_input(path).decode("utf-8-sig").replace("\r\n", "\n"))
    except OSError as error:
        raise SceneError(
            [Fault(user_file, key, f"{inherited}{error.strerror}", "a readable TOML file")]
        ) from error
    except RecursionError:
        raise SceneError([overrides.too_deep(user_file)]) from None
    # bad TOML, bytes that are not UTF-8, or an integer of thousands of digits
    except ValueError as error:
        raise SceneError([Fault(user_file, key, f"{inherited}{error}", "valid TOML")]) from error
    overrides.require_shallow(found, user_file)
    return found


def absolute(path: Path) -> Path:
    """``path`` from the root. Links are followed, except in a name that the file system refuses and
    in circular links: reading such a file gives the reason."""
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError):
        return Path.cwd() / path


def _without_dropped(base: dict, extra: dict, merged: dict) -> dict:
    """``merged`` without the inherited conditions that ``extra`` sets to "absent". Inherited roles
    lose these names too."""
    inherited, stated = (_table(table.get("conditions")) for table in (base, extra))
    dropped = {name for name, value in stated.items() if value == "absent" and name in inherited}
    if not dropped:
        return merged
    own = _table(extra.get("agreement"))
    roles = {
        role: [name for name in names_ if name not in dropped]
        for role, names_ in _table(merged.get("agreement")).items()
        if isinstance(names_, list) and role not in own
    }
    kept = {name: table for name, table in merged["conditions"].items() if name not in dropped}
    found = merged | {"conditions": kept}
    return found | {"agreement": merged["agreement"] | roles} if roles else found


def _with_springs(table: Any) -> list:
    """A table, and the tables of its springs, which may have files too."""
    springs = _table(table).get("springs")
    return [table, *(springs if isinstance(springs, list) else [])]


def _table(value: object) -> dict:
    return value if isinstance(value, dict) else {}


def _merged(base: dict, extra: dict) -> dict:
    merged = dict(base)
    for key, value in extra.items():
        if value == "absent" and key in merged:
            merged.pop(key, None)
        elif key in _FREE_TEXT and isinstance(value, dict) and isinstance(merged.get(key), dict):
            merged[key] = merged[key] | value
        elif (
            isinstance(value, dict)
            and isinstance(merged.get(key), dict)
            and not _other_choice(key, merged[key], value)
        ):
            merged[key] = _merged(merged[key], value)
        else:
            merged[key] = value
    return merged


def _changes(base: dict, extra: dict, prefix: str = "") -> Iterator[tuple[str, bool]]:
    """Dotted keys that ``_merged`` sets or, with True, drops."""
    for key, value in extra.items():
        if isinstance(value, dict) and value:
            inherited = table if isinstance(table := base.get(key), dict) else {}
            if inherited and _other_choice(key, inherited, value):
                yield f"{prefix}{key}", True
                inherited = {}
            yield from _changes(inherited, value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", overrides.is_drop(value)


def _other_choice(key: str, base: dict, extra: dict) -> bool:
    if key == "rail":
        return any(file in extra and file not in base for file in rail.FILES)
    choice = _CHOICE.get(key)
    return choice in extra and extra[choice] != base.get(choice)
