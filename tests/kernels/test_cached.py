"""Files of compiled kernels when two processes compile at the same time."""

import pytest
from numba import types
from numba.core.caching import IndexDataCacheFile

from tipoff.kernels.cached import KernelFiles

# As Numba makes them: types, processor, function.
OURS, THEIRS = (((kind,), ("x86_64",), ("code",)) for kind in (types.float64, types.int64))


def interleaved(kind, folder, monkeypatch):
    """Files of one kernel in which two processes keep code. The second one keeps its own after the
    first has chosen a name and before it has written its file."""
    first, second = (kind(str(folder), "kernel.py311", "stamp") for _ in range(2))
    write = first._save_data

    def late(name, data):
        second.save(THEIRS, "theirs")
        write(name, data)

    monkeypatch.setattr(first, "_save_data", late)
    index = first._load_index()
    monkeypatch.setattr(first, "_load_index", lambda: index)
    monkeypatch.setattr(second, "_load_index", dict)
    first.save(OURS, "ours")
    return kind(str(folder), "kernel.py311", "stamp")


def test_both_find_their_own_code(tmp_path, monkeypatch):
    kept = interleaved(KernelFiles, tmp_path, monkeypatch)
    assert (kept.load(OURS), kept.load(THEIRS)) == ("ours", "theirs")


def test_with_an_index_one_finds_the_code_of_the_other(tmp_path, monkeypatch):
    """Control: Numba's own files. Both processes read the index before either has changed it."""
    kept = interleaved(IndexDataCacheFile, tmp_path, monkeypatch)
    assert kept.load(THEIRS) == "ours"


@pytest.mark.parametrize("base, stamp", [("kernel.py311", "new code"), ("other.py311", "stamp")])
def test_code_of_another_kernel_is_not_found(tmp_path, base, stamp):
    KernelFiles(str(tmp_path), "kernel.py311", "stamp").save(OURS, "ours")
    assert KernelFiles(str(tmp_path), base, stamp).load(OURS) is None


def test_flush_removes_the_code_of_one_kernel(tmp_path):
    one, other = (KernelFiles(str(tmp_path), f"{name}.py311", "stamp") for name in ("one", "other"))
    one.save(OURS, "ours")
    other.save(OURS, "theirs")
    one.flush()
    assert one.load(OURS) is None and other.load(OURS) == "theirs"


def test_a_name_that_two_types_share_gives_no_wrong_code(tmp_path, monkeypatch):
    files = KernelFiles(str(tmp_path), "kernel.py311", "stamp")
    monkeypatch.setattr(files, "_name", lambda key: "kernel.py311.0.nbc")
    files.save(OURS, "ours")
    assert files.load(THEIRS) is None and files.load(OURS) == "ours"
