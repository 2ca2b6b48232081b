"""Every cache keeps its promise: a result that is there and whole is not made again, and nothing that
is missing, damaged, edited, half written or of another key is taken for it (X25)."""

import ast
import errno
import json
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.lowfi.ensemble.test_damaged_store import fill, opened, state_of
from tests.mechanics.test_damage import compliance
from tests.studies.synthetic import flight
from tipoff import cache, highfi, lowfi, scenes, sources
from tipoff.calibration import rail_compliance
from tipoff.files import (
    content_hash,
    fits_digest,
    require_whole,
    sealed,
    with_digest,
    write_json,
    write_sealed,
)
from tipoff.kernels.cached import KernelCache
from tipoff.lowfi.ensemble import store as ensembles
from tipoff.studies.limits import within
from tipoff.studies.populations import answers
from tipoff.workspace import kernel_marks
from tipoff.workspace import store as store_module
from tipoff.workspace import study as study_module
from tipoff.workspace.run import Run
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

SCENE, MINE, THEIRS = scenes.load("tiny"), "mine", "theirs"
KEY = "1" * 64
PLACES = 4  # in a file where a bit is inverted, evenly spread, beside those in its last lines


class Kept(NamedTuple):
    """A result in a cache, and another one of another key: ``MINE`` and ``THEIRS``. ``ask`` returns one as
    something that can be compared, and ``file`` where it is kept. ``made`` has an entry for each time
    that one was made. ``again`` is what a user reads of damage. Without its file, a result that is
    ``needed`` is an error."""

    ask: Callable[[str], Any]
    file: Callable[[str], Path]
    made: list
    again: str
    needed: bool = True


def run(folder, monkeypatch) -> Kept:
    """A run of the reference that takes no time."""
    made, study = [], Study(SCENE, folder / "tiny", Settings(workers=1))
    wide = study.highfi("phi15", {"contact.clearance": 6e-5}, "-wide")
    runs = {MINE: study.highfi("phi15"), THEIRS: wide}

    def execute(run, *_, **__):
        made.append(run.label)
        return flight(lambda t: np.full((t.size, 3), 0.125 * len(run.label)))

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    return Kept(
        lambda name: study.store.get(runs[name]).rate.tobytes(),
        lambda name: study.store.path(runs[name]),
        made,
        "phi15 is run again",
    )


def stage(folder, monkeypatch) -> Kept:
    """The result of a stage. That of another key would be in the same file."""
    monkeypatch.setattr(study_module.time, "perf_counter", lambda: 0.0)
    made = []

    def ask(name):
        def make():
            made.append(name)
            return {"name": name, "failed": [], "rate": 0.5}, []

        return Study(SCENE, folder / name, Settings()).stage("table", name, make)

    return Kept(ask, lambda name: folder / name / "table.json", made, "table is made again")


def walls(folder, monkeypatch) -> Kept:
    """A rail compliance."""
    made, sizes = [], {MINE: 8e-3, THEIRS: 4e-3}

    def compute(scene, element_size, degree, waits):
        made.append(element_size)
        return replace(compliance(), travel=np.array([0.0, element_size]))

    monkeypatch.setattr(rail_compliance, "computed", compute)
    return Kept(
        lambda name: rail_compliance.kept(SCENE, folder, sizes[name]).hash,
        lambda name: rail_compliance.kept_file(SCENE, folder, sizes[name]),
        made,
        "it is computed again",
    )


def searched(folder, monkeypatch) -> Kept:
    """The values of all cases within one set of tolerances."""
    made, again = [], "its cases are run again"

    def ask(name):
        def make():
            made.append(name)
            return np.random.default_rng(len(name)).random((50, len(answers.ALL)))

        files = within.kept(0.5, {"misalignment": 0.1})
        return files.get_or_make(folder / name, content_hash(name), again, make).tobytes()

    return Kept(ask, lambda name: folder / name, made, again)


def chunk(folder, monkeypatch) -> Kept:
    """The list of a chunk of an ensemble."""
    made = []

    def ask(name):
        store = opened(folder / name, {"scene": name, "cases": {"seed": 1}})
        made.extend([name] * len(fill(store)))
        return store.ensemble, state_of(store)

    monkeypatch.setattr(ensembles, "CHUNK", 20)
    again = "the cases 0 to 19 are run again"
    return Kept(ask, lambda name: folder / name / "done" / "000000.json", made, again)


def mark(folder, monkeypatch) -> Kept:
    """That kernels are there."""
    made: list[str] = []
    runs = {
        MINE: Run("lowfi", "a", SCENE, lowfi.Numerics()),
        THEIRS: Run("highfi", "a", SCENE, highfi.Numerics()),
    }

    def ask(name):
        if not kernel_marks.are_there(runs[name]):
            made.append(name)
            kernel_marks.remember(runs[name])
        return name

    def file(name):
        return kernel_marks.mark(runs[name])[0]

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    return Kept(ask, file, made, "its kernels are announced again", needed=False)


def source(folder, monkeypatch) -> Kept:
    """The code and the imports of a module."""
    made, parse, modules = [], ast.parse, {MINE: "tipoff.toml", THEIRS: "tipoff.files"}

    def parsed(content, *options, **named):
        made.append(len(content))
        return parse(content, *options, **named)

    def ask(name):
        sources.source.cache_clear()  # as in another process
        return sources.source(modules[name])

    def file(name):
        return next((folder / "sources").glob(f"{modules[name]}-*.json"))

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    monkeypatch.setattr(ast, "parse", parsed)
    return Kept(ask, file, made, "it is made again", needed=False)


def kernel(folder, monkeypatch) -> Kept:
    """The machine code of a kernel, here a text."""
    made, places = [], {}
    processor = SimpleNamespace(magic_tuple=lambda: "a processor")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))

    def ask(name):
        files = KernelCache(flight)
        if (found := files.stored((name,), processor)) is None:
            made.append(name)
            found = f"code for {name}"
            library = SimpleNamespace(has_dynamic_globals=False)
            code = SimpleNamespace(library=library, codegen=processor, _reduce=lambda: found)
            there = set(Path(files.cache_path).glob("*.nbc"))
            files.save_overload((name,), code)
            if new := set(Path(files.cache_path).glob("*.nbc")) - there:
                (places[name],) = new
        return found

    return Kept(ask, places.get, made, "the kernel is compiled again", needed=False)


ALL = (run, stage, walls, searched, chunk, mark, source, kernel)


@pytest.fixture(params=ALL, ids=lambda kind: kind.__name__)
def kept(request, tmp_path, monkeypatch) -> Kept:
    return request.param(tmp_path, monkeypatch)


def flipped(content: bytes, place: int) -> bytes:
    damaged = bytearray(content)
    damaged[place] ^= 1 << place % 8
    return bytes(damaged)


def damaged(path: Path) -> list[bytes]:
    """Contents that the file never had: one bit inverted, cut, longer, foreign, edited."""
    content = path.read_bytes()
    places = np.linspace(0, len(content) - 2, PLACES).astype(int).tolist()
    ends = [len(content) - back for back in (3, 75, 79, 145) if back < len(content)]
    found = [flipped(content, place) for place in [*places, *ends]]
    found += [b"", b"foreign", b"[]", content[: len(content) // 2], content[1:], content + b"\0"]
    if path.suffix == ".json":
        text = content.decode()
        found += [text.replace('"sha256"', '"sha255"').encode(), text[:-20].encode()]
        found += [text.replace('"key"', '"more": 1, "key"').encode()]
    return found


def test_a_result_is_made_once(kept, capsys):
    """And another one is not it."""
    first = kept.ask(MINE)
    assert kept.ask(MINE) == first and len(kept.made) == 1
    assert kept.ask(THEIRS) != first and len(kept.made) == 2
    assert kept.ask(MINE) == first and len(kept.made) == 2
    assert kept.again not in capsys.readouterr().err


def test_a_missing_file_is_made_again_without_a_word(kept, capsys):
    first = kept.ask(MINE)
    kept.file(MINE).unlink()
    assert kept.ask(MINE) == first and len(kept.made) == 2
    assert kept.again not in capsys.readouterr().err


@pytest.mark.case("X25")
def test_damage_anywhere_has_the_result_made_again(kept, capsys):
    """And is said, with what that leads to."""
    first, path = kept.ask(MINE), kept.file(MINE)
    for content in damaged(path):
        path.write_bytes(content)
        count = len(kept.made)
        capsys.readouterr()
        assert kept.ask(MINE) == first and len(kept.made) == count + 1, content[-200:]
        line = f"{path} is damaged or was edited: {kept.again}"
        assert capsys.readouterr().err.count(line) == 1
    assert kept.ask(MINE) == first and len(kept.made) == count + 1  # whole again


def test_the_result_of_another_key_is_never_taken_for_it(kept):
    """A whole file that was renamed, or one of a key with the same first digits."""
    first, _ = kept.ask(MINE), kept.ask(THEIRS)
    shutil.copyfile(kept.file(THEIRS), kept.file(MINE))
    # Control: the digest alone lets it pass
    if kept.file(MINE).suffix == ".json":
        assert fits_digest(json.loads(kept.file(MINE).read_bytes()))
    else:
        require_whole(kept.file(MINE))
    for _ in range(2):
        assert kept.ask(MINE) == first and len(kept.made) == 3


def full(_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_writing_that_fails_leaves_no_half_file(kept, monkeypatch):
    """As on a full disk. What can do without its file is found all the same; else the error says where."""
    first, path = kept.ask(MINE), kept.file(MINE)
    path.unlink()
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        if kept.needed:
            with pytest.raises(Exception, match="No space left") as fault:
                kept.ask(MINE)
            assert str(path) in str(fault.value) or str(path.parent.parent) in str(fault.value)
        else:
            assert kept.ask(MINE) == first
    assert not path.exists() and not list(path.parent.glob(f".{path.name}*"))
    assert kept.ask(MINE) == first and path.exists()


def test_damage_is_said_once_until_the_file_is_whole_again(tmp_path, capsys):
    """As where a command looks at one stored result many times and does not make it."""
    path, files = tmp_path / "a.json", cache.documents(dict, dict)

    def said() -> int:
        assert files.get(path, KEY, "repeat the command") is None
        return capsys.readouterr().err.count("repeat the command")

    assert said() == 0
    path.write_text("{")
    assert [said(), said()] == [1, 0]
    files.put(path, KEY, {"a": 1})
    path.write_text("{")
    assert [said(), said()] == [1, 0]
    path.write_text(json.dumps(with_digest({"key": KEY})))
    assert files.get(path, KEY, "repeat the command") is not None
    path.write_text("{")
    assert said() == 1


def test_what_cannot_be_read_is_said_with_the_reason(tmp_path, capsys):
    (tmp_path / "a.json").mkdir()
    assert cache.documents(dict, dict).get(tmp_path / "a.json", KEY, "it is made again") is None
    assert "a.json cannot be read (Is a directory): it is made again" in capsys.readouterr().err


def test_a_whole_file_of_another_layout_is_damaged(tmp_path, capsys):
    """As another version of the program wrote it. Control: the right layout is read."""
    path = tmp_path / "a"
    binary = cache.binary(str.encode, lambda path: str(int(path.read_bytes().split()[0])))
    document = cache.documents(dict, lambda found: {"a": found["a"]})
    write_sealed(path, b"text", KEY)
    assert binary.get(path, KEY, "it is made again") is None
    assert binary.get_or_make(path, KEY, "", lambda: "12") == binary.get(path, KEY, "") == "12"
    write_json(path, {"key": KEY, "b": 1})
    assert document.get(path, KEY, "it is made again") is None
    assert document.get_or_make(path, KEY, "", lambda: {"a": 1}) == {"a": 1}
    assert document.get(path, KEY, "") == {"a": 1}
    assert capsys.readouterr().err.count("is damaged or was edited: it is made again") == 2


def test_a_key_is_read_only_from_its_line(tmp_path):
    """A file without a key has none, whatever its content."""
    write_sealed(tmp_path / "a", b"content", KEY)
    assert require_whole(tmp_path / "a") == KEY
    with sealed(tmp_path / "b") as temporary:
        temporary.write_bytes(f"\n# key {KEY}\nmore".encode())
    assert require_whole(tmp_path / "b") == ""


def test_an_untouched_result_is_read_once(tmp_path, monkeypatch):
    """And the same object is given to all, until its file is written by another process. The last are
    held. Control: a plain cache reads it again."""
    read = []
    files = cache.documents(dict, lambda found: read.append(1) or dict(found), cache.Held)
    plain = cache.documents(dict, lambda found: read.append(2) or dict(found))
    monkeypatch.setattr(cache, "time", SimpleNamespace(time_ns=lambda: 2**62))  # much later
    path = tmp_path / "a.json"
    first = files.put(path, KEY, {"a": 1})
    assert all(files.get(path, KEY, "") is first for _ in range(3)) and read == [1]
    assert plain.get(path, KEY, "") == first and plain.get(path, KEY, "") and read == [1, 2, 2]
    assert files.get(path, "2" * 64, "") is None
    write_json(path, {"a": 2, "key": KEY})
    assert files.get(path, KEY, "")["a"] == 2 and read[-2:] == [2, 1]
    for number in range(8):
        files.put(tmp_path / f"{number}.json", KEY, {})
    count = len(read)
    assert files.get(path, KEY, "") and len(read) == count + 1


def test_a_file_that_was_written_just_now_is_read_again(tmp_path):
    """A second write may have the same time."""
    files = cache.documents(dict, dict, cache.Held)
    path = tmp_path / "a.json"
    for number in range(20):
        write_json(path, {"a": number, "key": KEY})
        assert files.get(path, KEY, "")["a"] == number
