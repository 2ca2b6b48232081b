"""Files of compiled kernels: each process finds the code of its own types, none of another kernel."""

import threading
from dataclasses import dataclass
from unittest import mock

import pytest
from numba.core.caching import IndexDataCacheFile

from tipoff import files
from tipoff.kernels import cached
from tipoff.kernels.cached import KernelCache

OURS, THEIRS = ("types of ours",), ("types of theirs",)


class Met(str):
    """A text that calls a function while it is written to a file."""

    def __new__(cls, text, function):
        made = super().__new__(cls, text)
        made.function = function
        return made

    def __reduce__(self):
        self.function()
        return str, (str(self),)


def one():
    """A kernel."""


def other():
    """A second one of the same module."""


class Processor:
    """What the name of a file takes from the generator of machine code."""

    def __init__(self, *kind):
        self._kind = kind or ("a processor", "its features")

    def magic_tuple(self):
        return "x86_64", *self._kind


class Kept:
    """Code of a kernel in our files."""

    def __init__(self, function=one):
        self.cache = KernelCache(function)

    def save(self, types, code, dynamic=False, processor=None):
        library = mock.Mock(has_dynamic_globals=dynamic)
        compiled = mock.Mock(
            library=library, codegen=processor or Processor(), **{"_reduce.return_value": code}
        )
        self.cache.save_overload(types, compiled)

    def load(self, types):
        return self.cache.stored(types, Processor())


@pytest.fixture(autouse=True)
def _own_folder(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))


def interleaved(opened):
    """What ``opened`` holds after two processes kept code. Both look for a free name before either has
    taken one, and theirs is written as a whole before the code of ours is."""
    theirs_begun, ours_begun, theirs_ended = (threading.Event() for _ in range(3))

    def first():
        theirs_begun.set()
        assert ours_begun.wait(10.0)

    def second():
        ours_begun.set()
        assert theirs_ended.wait(10.0)

    def keep_theirs():
        opened().save((Met(*THEIRS, first),), "theirs")
        theirs_ended.set()

    thread = threading.Thread(target=keep_theirs)
    thread.start()
    assert theirs_begun.wait(10.0)
    opened().save(OURS, Met("ours", second))
    thread.join()
    return opened()


def test_both_find_their_own_code():
    kept = interleaved(Kept)
    assert (kept.load(OURS), kept.load(THEIRS)) == ("ours", "theirs")


def test_with_an_index_one_finds_the_code_of_the_other(tmp_path):
    """Control: Numba's own files."""

    def opened():
        return IndexDataCacheFile(str(tmp_path), "kernel.py311", "stamp")

    assert interleaved(opened).load(THEIRS) == "ours"


def test_code_of_another_kernel_is_not_found():
    Kept(one).save(OURS, "ours")
    assert Kept(one).load(OURS) == "ours" and Kept(other).load(OURS) is None


@dataclass(frozen=True)
class Alike:
    """Types that differ although their names do not."""

    number: int

    def __repr__(self):
        return "alike"


def test_types_of_one_name_give_no_wrong_code():
    Kept().save((Alike(1),), "ours")
    assert Kept().load((Alike(2),)) is None and Kept().load((Alike(1),)) == "ours"


def test_an_address_of_this_process_is_not_kept():
    Kept().save(OURS, "ours", dynamic=True)
    assert Kept().load(OURS) is None


def test_a_kernel_is_used_although_the_disk_is_full(monkeypatch):
    monkeypatch.setattr(files.os, "fsync", mock.Mock(side_effect=OSError(28, "full")))
    Kept().save(OURS, "ours")
    assert Kept().load(OURS) is None


@pytest.fixture
def made(monkeypatch, tmp_path):
    """A package that has a kernel for a level of processors, and an empty cache of the user."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "builder"))
    Kept().save(OURS, "made", processor=Processor(cached.LEVEL, ""))
    (tmp_path / "builder" / "kernels").rename(tmp_path / "made")
    monkeypatch.setattr(cached, "MADE", tmp_path / "made")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "user"))
    has = dict.fromkeys(cached.FEATURES, True)
    monkeypatch.setattr(cached.binding, "get_host_cpu_features", lambda: has)
    cached.is_made_for_this_processor.cache_clear()
    yield has
    cached.is_made_for_this_processor.cache_clear()


def test_a_kernel_of_the_package_is_used_before_one_is_compiled(made):
    """Control: of another kernel, and of other types, there is none."""
    assert Kept().load(OURS) == "made" and cached.is_made(one)
    assert Kept().load(THEIRS) is None and Kept(other).load(OURS) is None
    assert not cached.is_made(other)
    Kept().save(OURS, "for this processor")
    assert Kept().load(OURS) == "for this processor"


def test_an_older_processor_runs_no_kernel_of_the_package(made):
    made["avx2"] = False
    assert Kept().load(OURS) is None and not cached.is_made(one)


def test_a_damaged_kernel_of_the_package_is_not_run(made, capsys):
    (path,) = cached.MADE.glob("*/*.nbc")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert Kept().load(OURS) is None and "is compiled again" in capsys.readouterr().err
