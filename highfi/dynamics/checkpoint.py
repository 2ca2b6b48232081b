"""Checkpoints: the state of a run as a file, from which an interrupted run continues to the same
bits.

A checkpoint holds everything of a ``run.Loop`` that evolves or is recorded. The file is a NumPy
archive (.npz) of plain arrays, without code, with a line for its digest (``tipoff.files``). It has
``header``, JSON that identifies the run, and one array per value, by its dotted name.

It is written between two steps, replaced atomically, and read only by a run of the same scene,
numerics, program and constant arrays. The processor is not compared: on another kind the run
continues, but its last bits may differ.
"""

import hashlib
import io
import json
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tipoff import sources
from tipoff.files import DamageError, require_whole, write_sealed

_OTHER = {
    "scene": "belongs to another scene",
    "numerics": "belongs to a run with other numerics",
    "program": "was written by another version of the program or of a library",
    "system": "belongs to a run on another mesh or with another step",
}


class CheckpointError(RuntimeError):
    """A file that cannot be resumed; ``reason`` completes the sentence that its path begins."""

    def __init__(self, path: Path, reason: str):
        self.path, self.reason = path, reason
        super().__init__(
            f"{path} {reason}; remove it, or run without resuming, to start from the beginning"
        )

    def __reduce__(self):
        return type(self), (self.path, self.reason)


class Checkpoint:
    """The checkpoint at ``path`` of one run, written every ``every`` seconds (wall clock)."""

    def __init__(self, path: str | Path, every: float, loop, numerics):
        if not every >= 0.0:
            raise ValueError(
                f"checkpoint_every: given {every!r}, expected a time of zero or more (s)"
            )
        self.path, self.every, self.due = Path(path), every, time.monotonic() + every
        self.header = {
            "scene": loop.setup.scene.hash,
            "numerics": numerics.as_dict(),
            "program": sources.of_runs("tipoff.highfi"),
            "system": digest(arrays({"constants": loop.stepper.constants()})),
        }

    def keep(self, loop) -> None:
        """Write the present ``loop`` if ``every`` seconds have passed."""
        if time.monotonic() >= self.due:
            self.write(loop)
            self.due = time.monotonic() + self.every

    def write(self, loop) -> None:
        """Write the present ``loop`` atomically. Raises OSError, for instance on a full disk."""
        archive = io.BytesIO()
        np.savez(
            archive,
            allow_pickle=False,
            header=json.dumps(self.header),
            **dict(arrays(evolving(loop))),
        )
        write_sealed(self.path, archive.getbuffer())

    def read(self) -> dict[str, np.ndarray] | None:
        """Saved arrays by name, or None without a file. Raises CheckpointError for a damaged file
        and for one of another run."""
        try:
            require_whole(self.path)
        except FileNotFoundError:
            return None
        except OSError as fault:
            raise CheckpointError(self.path, f"cannot be read ({fault.strerror})") from fault
        except DamageError as fault:
            raise CheckpointError(self.path, fault.reason) from fault
        try:
            with np.load(self.path, allow_pickle=False) as archive:
                saved = dict(archive)
            header = json.loads(saved.pop("header").item())
            others = {name: header[name] for name in _OTHER}
        except Exception as fault:  # NumPy and zipfile raise many kinds on foreign bytes
            raise CheckpointError(self.path, "is damaged or foreign") from fault
        for name, reason in _OTHER.items():
            if others[name] != self.header[name]:
                raise CheckpointError(
                    self.path, reason + _difference(others[name], self.header[name])
                )
        return saved

    def resume(self, loop, saved: dict[str, np.ndarray]) -> None:
        """Restore the result of ``read`` into ``loop``. Raises CheckpointError for values that do
        not fit the loop."""
        try:
            restore(loop, saved)
        except ValueError as fault:
            raise CheckpointError(self.path, f"is damaged or foreign: it {fault}") from fault


def restore(loop, saved: dict[str, np.ndarray]) -> None:
    """Put ``saved`` into a loop that has begun; arrays are filled in place, because kernels need them
    aligned. Raises ValueError, before it changes anything, for values that do not fit the loop."""
    for name, value in evolving(loop).items():
        if isinstance(value, list):
            _require(name, saved, (None,))
        else:
            for key, array in arrays({name: value}):
                _require(key, saved, array.shape, array.dtype)
    for owner in (loop.stepper, loop.recorded):
        for name, value in _values(owner).items():
            if isinstance(value, list):
                setattr(owner, name, list(saved[name]))
            elif isinstance(value, (tuple, np.ndarray)):
                for key, array in arrays({name: value}):
                    array[...] = saved[key]
            else:
                setattr(owner, name, type(value)(saved[name].item()))


def _require(
    name: str, saved: dict[str, np.ndarray], shape: tuple, dtype: np.dtype | None = None
) -> None:
    """Raise ValueError for a missing value, or another shape or type; a list may have any length
    and type."""
    if name not in saved:
        raise ValueError(f"lacks the value {name}")
    array = saved[name]
    fits = array.shape == shape if dtype is not None else array.ndim > 0
    if not fits or (dtype is not None and array.dtype.kind != dtype.kind):
        raise ValueError(f"has {name} in the shape {array.shape} of {array.dtype}")


def evolving(loop) -> dict[str, Any]:
    """Values that change during a run: records, lists of samples, numbers and text, by name."""
    return _values(loop.stepper) | _values(loop.recorded)


def _values(owner) -> dict[str, Any]:
    return {name: value for name, value in vars(owner).items() if name != "setup"}


def arrays(parts: dict[Any, Any]) -> Iterator[tuple[str, np.ndarray]]:
    """All values in ``parts`` as arrays by dotted name, not copied. Records are opened to any
    depth; None is left out."""
    for name, part in parts.items():
        if hasattr(part, "_asdict"):
            yield from arrays({f"{name}.{field}": value for field, value in part._asdict().items()})
        elif part is not None:
            yield str(name), np.asarray(part)


def digest(named: Iterable[tuple[str, np.ndarray]]) -> str:
    """Hexadecimal SHA-256 of names, types, shapes and values."""
    found = hashlib.sha256()
    for name, array in named:
        found.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        found.update(array.tobytes())
    return found.hexdigest()


def _difference(saved: Any, requested: Any) -> str:
    """The fields that differ, in words; nothing for digests."""
    if not isinstance(requested, dict):
        return ""
    changed = [
        f"{name} {saved.get(name)}, not {value}"
        for name, value in requested.items()
        if saved.get(name) != value
    ]
    return f" ({', '.join(changed)})"
