"""Files in which Numba keeps compiled kernels, each with a digest of its content.

Numba loads what it finds, and a damaged file ends the program with a traceback or a fault of the
processor. Here a damaged file counts as missing, so the kernel is compiled again and the file
replaced. A file that cannot be written, as on a full disk, is left out.
"""

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path

from numba.core.caching import IndexDataCacheFile

from tipoff.files import DamageError, require_whole, sealed


class KernelFiles(IndexDataCacheFile):
    """The index and the machine code of one kernel."""

    def _load_index(self) -> dict:
        try:
            require_whole(self._index_path)
        except (DamageError, OSError):
            return {}
        return super()._load_index()

    def _load_data(self, name: str):
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
