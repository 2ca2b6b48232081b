"""Sparse solutions wait for no second thread of BLAS, and return the threads they found."""

import os
import subprocess
import sys

import pytest
from scipy.sparse.linalg import splu
from threadpoolctl import threadpool_info, threadpool_limits

from tests.highfi.support import tiny
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.statics import assembly, solve

pytestmark = pytest.mark.skipif(os.cpu_count() == 1, reason="one core has one thread anyway")
PROGRAM = """
import sys
sys.argv = ["tipoff", "--version"]
from tipoff.__main__ import main
try:
    main()
finally:
    import scipy.linalg, threadpoolctl
    print(*{pool["num_threads"] for pool in threadpoolctl.threadpool_info() if pool["user_api"] == "blas"})
"""


def threads() -> set[int]:
    """Numbers of threads of the BLAS libraries that are loaded."""
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


class Factor:
    """A sparse factor that notes the threads with which it is made and used."""

    def __init__(self, matrix, **options):
        self.seen = [threads()]
        self.factor = splu(matrix, **options)

    def solve(self, loads):
        """As the factor does."""
        self.seen.append(threads())
        return self.factor.solve(loads)


def test_a_solution_has_one_thread_and_gives_back_the_others(monkeypatch):
    made = []
    monkeypatch.setattr(
        solve, "splu", lambda *given, **options: made.append(Factor(*given, **options)) or made[0]
    )
    mesh = highfi.prepare(tiny(), Numerics(element_size=0.016))
    operator = assembly.of_material(mesh, tiny().rail.material)
    with threadpool_limits(limits=2, user_api="blas"):
        assert threads() == {2}
        clamped = solve.Clamped(operator)
        clamped.solve(clamped.stiffness[:, [0]].toarray())
        assert made[0].seen == [{1}, {1}] and threads() == {2}


@pytest.mark.parametrize("chosen, expected", [({}, "1"), ({"OPENBLAS_NUM_THREADS": "2"}, "2")])
def test_the_command_has_one_thread_unless_the_user_chose(chosen, expected):
    environment = {name: text for name, text in os.environ.items() if "NUM_THREADS" not in name}
    said = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment | chosen, capture_output=True, text=True
    )
    assert said.stdout.splitlines()[-1] == expected, said.stderr


def test_a_factor_without_memory_is_refused_with_the_remedy(monkeypatch):
    def full(*_given, **_options):
        raise MemoryError

    monkeypatch.setattr(solve, "splu", full)
    mesh = highfi.prepare(tiny(), Numerics(element_size=0.016))
    with pytest.raises(
        MemoryError, match=r"degrees of freedom; larger elements .*studies.element_size"
    ):
        solve.Clamped(assembly.of_material(mesh, tiny().rail.material))
