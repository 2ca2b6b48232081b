"""The state of tipoff that a result names."""

import subprocess

import pytest

from tipoff.workspace import machine

FILES = ("docs/peers.png", "README.md", "validation/peers/kept/exudyn.json", "lowfi/ending.py")


@pytest.mark.parametrize(
    "changed, mark",
    [((), ""), (FILES[:3], ""), (FILES[3:], "+")],
    ids=["nothing", "documents, kept results", "code"],
)
def test_an_edit_that_could_change_numbers_is_marked(tmp_path, changed, mark):
    def git(*words: str) -> str:
        own = ("-c", "user.name=a", "-c", "user.email=a@b.c")
        done = subprocess.run(
            ["git", "-C", tmp_path, *own, *words], capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    git("init", "-q")
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("before")
    git("add", ".")
    git("commit", "-q", "-m", "all")
    for name in changed:
        (tmp_path / name).write_text("after")
    assert machine.commit(tmp_path) == git("rev-parse", "--short=12", "HEAD") + mark
