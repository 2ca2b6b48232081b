"""Files in which Numba keeps compiled kernels: one for each combination of types, with a digest of
its content.

Numba numbers these files and keeps the numbers in an index. Two processes that compile at the same
time may take the same number; then one loads the machine code of the other, made for other types.
Numba also loads damaged files, which ends the program with a traceback or a segmentation fault.
Here the name of a file follows from the types, and there is no index. A damaged file counts as
missing: the kernel is compiled again and the file replaced. A file that cannot be written, as on a
full disk, is left out.
"""

import contextlib
import hashlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from numba.core.caching import IndexDataCacheFile

from tipoff.files import DamageError, require_whole, sealed


class KernelFiles(IndexDataCacheFile):
    """The machine code of one kernel. A ``key`` has the types, the processor and the function."""

    def __init__(self, cache_path: str, filename_base: str, source_stamp: str):
        super().__init__(cache_path, filename_base, source_stamp)
        self._base = filename_base

    def save(self, key: tuple, data: Any) -> None:
        """Keep ``data``, as Numba makes it, under ``key``."""
        self._save_data(self._name(key), (self._origin(key), data))

    def load(self, key: tuple) -> Any:
        """What is kept under ``key``, or None."""
        try:
            origin, data = self._load_data(self._name(key))
        except OSError:
            return None
        return data if origin == self._origin(key) else None

    def flush(self) -> None:
        """Remove what is kept of this kernel."""
        for path in Path(self._cache_path).glob(f"{self._base}.*.nbc"):
            path.unlink(missing_ok=True)

    def _origin(self, key: tuple) -> tuple:
        return self._version, self._source_stamp, key

    def _name(self, key: tuple) -> str:
        digest = hashlib.sha256(repr(self._origin(key)).encode()).hexdigest()
        return f"{self._base}.{digest[:16]}.nbc"

    def _load_data(self, name: str) -> Any:
        try:
            require_whole(self._data_path(name))
        except DamageError as fault:
            raise OSError(str(fault)) from fault  # which Numba takes for a file that is missing
        return super()._load_data(name)

    @contextlib.contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[io.BytesIO]:
        content = io.BytesIO()
        yield content
        with contextlib.suppress(OSError), sealed(Path(filepath)) as temporary:
            temporary.write_bytes(content.getvalue())
