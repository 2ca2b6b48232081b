"""Check for files of a scene that changed after it was read: a variation would silently have
another curve or rail than its scene."""

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.effects.thrust import MeasuredTable, ThrustTable
from tipoff.scenes.rail import RailTable

Tables = tuple[ThrustTable, RailTable]


def require(before: Tables, after: Tables, source: str) -> None:
    """Raise SceneError, naming ``source``, if a file in the tables of both scenes has another
    content in ``after``, which was read later."""
    changed = []
    (old, rail), (new, later) = before, after
    if (
        isinstance(old, MeasuredTable)
        and isinstance(new, MeasuredTable)
        and new.file is not None
        and old.file == new.file
    ):
        pairs = zip(old.curve(), new.curve())
        if not all(np.array_equal(first, second) for first, second in pairs):
            changed.append(("thrust.file", new.file))
    if isinstance(old, PushedTable) and isinstance(new, PushedTable):
        known = {path: push for _, path, push in old.files()}
        changed += [
            (f"thrust.{key}", path)
            for key, path, push in new.files()
            if path in known and not all(map(np.array_equal, known[path], push))
        ]
    key = later.GIVEN_BY
    file = getattr(later, key, None)
    if (
        file is not None
        and getattr(rail, key, None) == file
        and rail.contents() != later.contents()
    ):
        changed.append((f"rail.{key}", str(file)))
    if changed:
        expected = (
            "the file as it was when the scene was read: it has changed, read the scene again"
        )
        raise SceneError([Fault(source, name, repr(path), expected) for name, path in changed])
