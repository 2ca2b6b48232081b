"""Files of compiled kernels when two processes compile at the same time."""

import threading
from dataclasses import dataclass

import pytest

from tipoff.kernels.cached import KernelFiles

NUMBA_FILES = KernelFiles.__base__  # Numba's own class, for controls
OURS, THEIRS = "types of ours", "types of theirs"


class Met(str):
    """A text that calls a function while it is written to a file."""

    def __new__(cls, text, function):
        made = super().__new__(cls, text)
        made.function = function
        return made

    def __reduce__(self):
        self.function()
        return str, (str(self),)


def files(kind, folder, name="kernel.py311", stamp="stamp"):
    return kind(cache_path=str(folder), filename_base=name, source_stamp=stamp)


def interleaved(kind, folder):
    """Files of one kernel in which two processes keep code. Both look for a free name before either
    has taken one, and theirs is written as a whole before the code of ours is."""
    theirs_begun, ours_begun, theirs_ended = (threading.Event() for _ in range(3))

    def first():
        theirs_begun.set()
        assert ours_begun.wait(10.0)

    def second():
        ours_begun.set()
        assert theirs_ended.wait(10.0)

    def keep_theirs():
        files(kind, folder).save(Met(THEIRS, first), "theirs")
        theirs_ended.set()

    other = threading.Thread(target=keep_theirs)
    other.start()
    assert theirs_begun.wait(10.0)
    files(kind, folder).save(OURS, Met("ours", second))
    other.join()
    return files(kind, folder)


def test_both_find_their_own_code(tmp_path):
    kept = interleaved(KernelFiles, tmp_path)
    assert (kept.load(OURS), kept.load(THEIRS)) == ("ours", "theirs")


def test_with_an_index_one_finds_the_code_of_the_other(tmp_path):
    """Control: Numba's own files."""
    assert interleaved(NUMBA_FILES, tmp_path).load(THEIRS) == "ours"


@pytest.mark.parametrize("name, stamp", [("kernel.py311", "new code"), ("other.py311", "stamp")])
def test_code_of_another_kernel_is_not_found(tmp_path, name, stamp):
    files(KernelFiles, tmp_path).save(OURS, "ours")
    assert files(KernelFiles, tmp_path, name, stamp).load(OURS) is None


def test_flush_removes_the_code_of_one_kernel(tmp_path):
    one, other = (files(KernelFiles, tmp_path, name) for name in ("one.py311", "other.py311"))
    one.save(OURS, "ours")
    other.save(OURS, "theirs")
    one.flush()
    assert one.load(OURS) is None and other.load(OURS) == "theirs"


@dataclass(frozen=True)
class Alike:
    """Types that differ although their names do not."""

    number: int

    def __repr__(self):
        return "alike"


def test_types_of_one_name_give_no_wrong_code(tmp_path):
    kept = files(KernelFiles, tmp_path)
    kept.save(Alike(1), "ours")
    assert kept.load(Alike(2)) is None and kept.load(Alike(1)) == "ours"
