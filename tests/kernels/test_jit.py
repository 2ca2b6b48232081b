"""A changed callee: a compiled caller contains its old callee unless its place in the cache depends
on all the code it uses. Changed comments compile nothing."""

import functools
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from numba.core import event

from tipoff.kernels import jit
from tipoff.kernels.jit import entry, kernel

ROOT = Path(__file__).resolve().parents[2]
CALLER = (
    "from tipoff.highfi.callee import value\nfrom tipoff.kernels.jit import entry\n\n\n@entry\ndef "
    'doubled():\n    """Twice the value."""\n    return 2.0 * value()\n'
)
CALLEE = 'from tipoff.kernels.jit import kernel\n\n\n@kernel\ndef value():\n    """A value."""\n    return {}\n'
ASK = (
    "from tipoff.highfi.caller import doubled; "
    "print(doubled(), sum(doubled.stats.cache_misses.values()))"
)
ASK_PART = "from tipoff.highfi.callee import value; print(value(), 0)"
ASK_TESTS = ASK.replace("tipoff.highfi.caller", "tests.caller")
# Each question is answered by a process of its own, which has loaded nothing of the project before.
SERVER = """
import json, os, sys, traceback
import numba.core.caching, numba.core.compiler, numba.core.registry
assert "tipoff" not in sys.modules
for line in sys.stdin:
    asked = json.loads(line)
    child = os.fork()
    if child == 0:
        os.chdir(asked["folder"])
        os.environ["NUMBA_CACHE_DIR"] = asked["cache"]
        try:
            exec(asked["question"], {})
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        sys.stdout.flush()
        os._exit(0)
    print("ended", os.waitpid(child, 0)[1], flush=True)
"""
# Numba's own cache: all kernels in one place, distinguished by their own code alone.
STAMP = '    return hashlib.sha256("\\n".join([repr(of_all), *parts]).encode()).hexdigest()[:16]'
PRIVATE = '                function.linkage = "private"'


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A project whose callee is one, with the kernels of both callers stored."""
    project = tmp_path_factory.mktemp("stored")
    package = project / "tipoff"
    shutil.copytree(
        ROOT / "tipoff" / "kernels",
        package / "kernels",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    for name in ("__init__", "cache", "files", "sources"):
        shutil.copy(ROOT / "tipoff" / f"{name}.py", package)
    (package / "highfi").mkdir()
    (package / "highfi" / "__init__.py").write_text("")
    (package / "highfi" / "caller.py").write_text(CALLER)
    (project / "tests").mkdir()
    (project / "tests" / "__init__.py").write_text("")
    (project / "tests" / "caller.py").write_text(CALLER)
    write_callee(project, 1.0)
    assert ask(project) == ask(project, ASK_TESTS) == (2.0, 1)
    return project


@pytest.fixture
def project(stored, tmp_path):
    """A copy of it, which a test may change."""
    return shutil.copytree(stored, tmp_path / "project")


@functools.cache
def _server() -> subprocess.Popen:
    """The process that loads Numba once and begins a process for each question."""
    return subprocess.Popen(
        [sys.executable, "-c", SERVER],
        cwd=tempfile.gettempdir(),
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


@pytest.fixture(scope="module", autouse=True)
def ended():
    """Ends it."""
    yield
    if _server.cache_info().currsize:
        _server().communicate()
        _server.cache_clear()


def ask(project: Path, question: str = ASK) -> tuple[float, int]:
    """What the caller returns in a new process, and how many of its kernels were compiled there."""
    asked = {"folder": str(project), "cache": str(project / "cache"), "question": question}
    server = _server()
    print(json.dumps(asked), file=server.stdin, flush=True)
    assert select.select([server.stdout], [], [], 60.0)[0]
    said = server.stdout.readline()
    if not said.startswith("ended"):
        number, compiled = said.split()
        said = server.stdout.readline()
    assert said == "ended 0\n"  # its traceback is among what pytest shows
    return float(number), int(compiled)


def ask_anew(project: Path) -> tuple[float, int]:
    """The same in an interpreter of its own, whose hashes and addresses are others."""
    run = subprocess.run(
        [sys.executable, "-c", ASK],
        cwd=project,
        env=os.environ | {"NUMBA_CACHE_DIR": str(project / "cache"), "PYTHONHASHSEED": "1"},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    number, compiled = run.stdout.split()
    return float(number), int(compiled)


def write_callee(project: Path, value: float) -> None:
    (project / "tipoff" / "highfi" / "callee.py").write_text(CALLEE.format(value))


def of_the_caller(project: Path) -> Path:
    """The file in which the kernel of the caller is stored."""
    (found,) = (project / "cache").rglob("tipoff.highfi.caller-*/*.nbc")
    return found


@pytest.mark.parametrize("question", [ASK, ASK_TESTS], ids=["of tipoff", "of the tests"])
def test_an_edited_callee_is_used(project, question):
    """And the kernel that is stored for the callee as it was."""
    found = []
    for value in (3.0, 1.0):
        write_callee(project, value)
        found.append(ask(project, question))
    assert found == [(6.0, 1), (2.0, 0)]


def test_a_kernel_that_python_calls_in_passing_is_kept_and_never_stale(project):
    """Its caller is stored, and found by the next process."""
    kept = []
    for value in (1.0, 1.0, 3.0):
        write_callee(project, value)
        assert ask(project, ASK_PART) == (value, 0)
        files = (project / "cache").rglob("*.nbc")
        kept.append({path: path.stat().st_mtime_ns for path in files})
    assert len(kept[0]) == 3 and kept[1] == kept[0] and len(kept[2]) == 4


def test_only_kernels_that_python_calls_have_machine_code(project):
    kept = [path.name.partition("-")[0] for path in (project / "cache").rglob("*.nbc")]
    assert kept == ["caller.doubled"] * 2


@kernel
def root(number):
    """Square root of a number, as a kernel that only kernels call."""
    if number < 0.0:
        raise ValueError("a negative number")
    return number**0.5


@entry
def sum_of_roots(one, other):
    """Sum of two square roots."""
    return root(one) + root(other)


def test_python_calls_a_kernel_and_meets_its_exceptions():
    """Control: that the caller has the same kernel inside."""
    assert root(9.0) == 3.0 and sum_of_roots(9.0, 16.0) == 7.0
    for call in (lambda: root(-1.0), lambda: sum_of_roots(1.0, -1.0)):
        with pytest.raises(ValueError, match="a negative number"):
            call()


def test_functions_of_numba_are_compiled_once_for_all_kernels(monkeypatch):
    """Numba finds them by the options of the kernel, whose comparison is our own. Control: no options
    are equal."""

    def compiled(number) -> int:
        def lower(one, other):
            return min(one, other)

        def higher(one, other):
            return -min(-one, -other)

        low, high = kernel(lower), kernel(higher)

        def both(one, other):
            return low(one, other) + high(one, other)

        with event.install_recorder("numba:compile") as seen:
            assert entry(both)(number(2), number(3)) == 5
        names = [one.data["dispatcher"].py_func.__qualname__ for _, one in seen.buffer]
        return sum("ol_min" in name for name in names) // 2  # each begins and ends

    assert compiled(np.float32) == 1  # no other kernel has this type
    monkeypatch.setattr(jit.Options, "__eq__", lambda one, other: one is other)
    assert compiled(float) == 2


def test_comments_compile_nothing(project):
    """Docstrings and comments above a kernel move its lines and change its file. Nor does another
    interpreter compile anything."""
    assert ask_anew(project) == (2.0, 0)
    for name in ("caller", "callee"):
        source = project / "tipoff" / "highfi" / f"{name}.py"
        text = source.read_text().replace("Twice", "Two times").replace("A value", "One number")
        source.write_text('"""What it is for."""\n\n# a remark\n' + text)
    assert ask(project) == (2.0, 0)


def test_without_the_digest_the_old_callee_is_used(project):
    """Control: the wrong result that the digest prevents. The digest is not needed any more if
    Numba changes this."""
    source = project / "tipoff" / "kernels" / "called.py"
    text = source.read_text()
    assert STAMP in text
    source.write_text(text.replace(STAMP, '    return "fixed" if parts else ""'))
    found = []
    for value in (1.0, 3.0):
        write_callee(project, value)
        found.append(ask(project)[0])
    assert found == [2.0, 2.0]


def test_a_kernel_with_one_other_byte_is_compiled_again(project):
    """Numba would run it."""
    kept = of_the_caller(project)
    content = bytearray(kept.read_bytes())
    content[len(content) // 2] ^= 1
    kept.write_bytes(content)
    assert ask(project) == (2.0, 1)


# Too long for LLVM to inline. In the entry LLVM drops the argument that is not used.
LONG = (
    "import math\n\nfrom tipoff.kernels.jit import entry, kernel\n\n\n@kernel\n"
    "def long(unused, values, scale):\n    found = 0.0\n    for value in values:\n"
    + "".join(
        f"        found += scale * math.sin({n} * value) / (1.0 + math.exp({n} * value))\n"
        for n in range(40)
    )
    + "    return found\n\n\n@entry\ndef twice(unused, values):\n"
    "    return long(unused, values, 1.0) + long(unused, values, 2.0)\n"
)
ASK_BOTH = (
    "import numpy as np; from tipoff.highfi.long import long, twice; "
    "values = np.linspace(0.1, 1.0, 7); twice(values, values); "
    "print(long(values, values, 1.0) / long.py_func(values, values, 1.0), 0)"
)


def test_a_part_that_python_calls_is_not_that_of_an_entry(project):
    """LLVM changes the arguments of the parts of an entry. If they had symbols, the loader would call
    them in the place of the same part called from Python."""
    (project / "tipoff" / "highfi" / "long.py").write_text(LONG)
    assert ask(project, ASK_BOTH)[0] == pytest.approx(1.0, rel=1e-12)


def test_with_symbols_the_part_of_the_entry_is_called(project):
    """Control: its arguments are at other places."""
    source = project / "tipoff" / "kernels" / "jit.py"
    text = source.read_text()
    assert PRIVATE in text
    source.write_text(text.replace(PRIVATE, PRIVATE.replace("private", "internal")))
    (project / "tipoff" / "highfi" / "long.py").write_text(LONG)
    done = subprocess.run(
        [sys.executable, "-c", ASK_BOTH],
        cwd=project,
        env=os.environ | {"NUMBA_CACHE_DIR": str(project / "cache")},
        capture_output=True,
        text=True,
        timeout=60,
    )
    found = done.stdout.split()
    assert done.returncode < 0 or float(found[0]) != pytest.approx(1.0, rel=1e-3)
