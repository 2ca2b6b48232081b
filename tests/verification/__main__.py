"""Records what the tests of the cases compare, and writes docs/verification_and_validation.md.

    python -m tests.verification                        the page, from what is recorded
    python -m tests.verification tests/lowfi ...        run the tests of cases below these paths first
    python -m tests.verification --first tests          each with its first parameters alone

Entries of tests that ran replace those recorded before; entries of tests that are gone are dropped.
"""

import argparse
import json
import sys
import tempfile

import pytest

from tests.verification import page, reading
from tests.verification.recorder import Recorder


def record(paths: list[str], first: bool) -> int:
    """Run the tests below ``paths`` that are marked with a case and are not slow; the exit code of
    pytest."""
    recorder = Recorder(first)
    with tempfile.TemporaryDirectory() as cache:
        # asserts are compiled anew, with the hook that tells their values
        sys.pycache_prefix = cache
        code = pytest.main(
            [
                "-q",
                "-n0",
                "-m",
                "case and not slow",
                "-o",
                "enable_assertion_pass_hook=true",
                *paths,
            ],
            plugins=[recorder],
        )
    keep(recorder.kept)
    return int(code)


def keep(new: dict) -> None:
    """Lay ``new`` entries over those that are recorded, a line each."""
    known = {f"{test.file}::{test.name}" for test in reading.all_tests()}
    lines = [
        f"{json.dumps(name)}: {json.dumps(entry)}"
        for name, entry in sorted((page.recorded() | new).items())
        if name in known
    ]
    page.RECORDED.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def main() -> int:
    """Record where paths are given, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m tests.verification")
    parser.add_argument("paths", nargs="*", help="files and folders of tests")
    parser.add_argument("--first", action="store_true", help="the first parameters of each test")
    asked = parser.parse_args()
    code = record(asked.paths, asked.first) if asked.paths else 0
    page.PAGE.write_text(page.text())
    return code


if __name__ == "__main__":
    sys.exit(main())
