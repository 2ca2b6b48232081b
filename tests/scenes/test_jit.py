"""The stale kernel: a compiled caller keeps its old callee inside unless the cache is named by
every source."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scenes import rotation
from scenes.jit import contains

ROOT = Path(__file__).resolve().parents[2]
CALLER = (
    "from highfi.callee import value\nfrom scenes.jit import njit\n\n\n@njit\ndef "
    "doubled():\n    return 2.0 * value()\n"
)
CALLEE = "from scenes.jit import njit\n\n\n@njit\ndef value():\n    return {}\n"
# The trap as Numba leaves it: the same kernels with the cache in one fixed place.
FIXED = "    return (Path(chosen) if chosen else default)"
ASK = (
    "from highfi.caller import doubled; from scenes.jit import kernel_digest; print(doubled(), "
    "kernel_digest())"
)


@pytest.fixture
def project(tmp_path):
    shutil.copytree(
        ROOT / "scenes", tmp_path / "scenes", ignore=shutil.ignore_patterns("__pycache__")
    )
    (tmp_path / "scenes" / "__init__.py").write_text("")
    (tmp_path / "highfi").mkdir()
    (tmp_path / "highfi" / "__init__.py").write_text("")
    (tmp_path / "highfi" / "caller.py").write_text(CALLER)
    return tmp_path


def ask(project: Path, value: float) -> tuple[float, str]:
    (project / "highfi" / "callee.py").write_text(CALLEE.format(value))
    environment = os.environ | {
        "NUMBA_CACHE_DIR": str(project / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    run = subprocess.run(
        [sys.executable, "-c", ASK],
        cwd=project,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert run.returncode == 0, run.stderr
    number, digest = run.stdout.split()
    return float(number), digest


def test_an_edited_callee_is_used(project):
    first, second, again = ask(project, 1.0), ask(project, 3.0), ask(project, 1.0)
    assert (first[0], second[0], again[0]) == (2.0, 6.0, 2.0)
    assert first[1] == again[1] != second[1]


def test_without_the_digest_the_old_callee_is_used(project):
    """Control: this is the wrong result that the digest prevents. If Numba mends it, the digest can
    go."""
    source = project / "scenes" / "jit.py"
    text = source.read_text()
    assert FIXED + " / kernel_digest()" in text
    source.write_text(text.replace(FIXED + " / kernel_digest()", FIXED))
    assert (ask(project, 1.0)[0], ask(project, 3.0)[0]) == (2.0, 2.0)


CHANGES = """
from pathlib import Path
from scenes.jit import kernel_digest
root = Path("scenes")
print(kernel_digest())
for change in (lambda: (root / "body.py").write_text((root / "body.py").read_text() + " "),
               lambda: (root / "effects" / "friction.py").write_text(""), lambda: (root / "more.py").write_text(""),
               lambda: (root / "body.py").rename(root / "corpus.py"), lambda: (root / "units.py").unlink()):
    change()
    print(kernel_digest())
"""


def test_any_change_of_a_source_changes_the_digest(project):
    run = subprocess.run(
        [sys.executable, "-c", CHANGES], cwd=project, capture_output=True, text=True, timeout=60
    )
    digests = run.stdout.split()
    assert len(digests) == 6, run.stderr
    assert len(set(digests)) == 6


def test_code_names_whole_functions_only():
    """A name that begins, ends or contains another one is not taken for it, and neither is the same
    name in another module."""
    code = b"..._ZN08NumbaEnv6scenes8rotation6rotateB2v1B52c8tJ..."
    assert contains(code, rotation.rotate)
    assert not contains(code, rotation.unrotate) and not contains(
        code.replace(b"8rotation", b"6motion"), rotation.rotate
    )
    assert b"rotat" in code and not contains(code, rotation.matrix)
    assert not contains(code.replace(b"6rotateB", b"9rotated_byB"), rotation.rotate)
