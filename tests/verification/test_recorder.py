"""The recorder keeps the comparison nearest to its tolerance, orders, and controls apart."""

import json
import subprocess
import sys
import textwrap

import pytest

from tests.verification import reading

TESTS = """
    import numpy as np
    import pytest


    def slopes():
        return [1.8, 1.95]


    def measure():
        return np.array([2.0, 3.0001])


    @pytest.mark.case("O1")
    @pytest.mark.parametrize("step", [1, 2])
    def test_one(step):
        found = measure()
        assert found == pytest.approx([2.0, 3.0], abs=2e-4)
        np.testing.assert_allclose(found, [2.0, 3.0], rtol=1e-3)
        assert abs(found[1] - 3.0) < 1e-3 and abs(found[1] - 3.0) <= 1e-4 * found[0]
        assert abs(found[0]) < 3.0  # a bound of a quantity
        assert (np.array(slopes()) > 1.7).all() and max(slopes()) < 2.1
        assert found[0] < 100.0
        # Control: the coarse one is off.
        assert found[0] > 1.5


    @pytest.mark.case("X1")
    def test_yes_or_no():
        assert measure() is not None


    def test_of_no_case():
        assert 1.0 == pytest.approx(1.0 + 1e-9)
    """
RUN = """
import json, sys, pytest
from tests.verification.recorder import Recorder
found = Recorder()
sys.pycache_prefix = sys.argv[1]
code = pytest.main(["-q", "-n0", "-p", "no:hypothesispytest", "-o", "enable_assertion_pass_hook=true",
                    "--rootdir", sys.argv[2], "-c", sys.argv[2] + "/pyproject.toml", sys.argv[3]],
                   plugins=[found])
print("KEPT", json.dumps(found.kept))
sys.exit(int(code))
"""


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """What is recorded of the tests above, in an interpreter of their own."""
    folder = tmp_path_factory.mktemp("recorded")
    path = folder / "test_made_up.py"
    path.write_text(textwrap.dedent(TESTS))
    run = subprocess.run(
        [sys.executable, "-c", RUN, str(folder / "cache"), str(reading.ROOT), str(path)],
        capture_output=True,
        text=True,
        cwd=reading.ROOT,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    found = json.loads(run.stdout.split("KEPT ")[1])
    return {name.split("::")[1]: entry for name, entry in found.items()}


def test_the_comparison_nearest_to_its_tolerance_is_kept(kept):
    """Of three comparisons of one number, in both runs of the test. A bound that is no error is not
    counted."""
    entry = kept["test_one"]
    assert entry["cases"] == ["O1"]
    assert entry["worst"]["ours"] == 3.0001 and entry["worst"]["answer"] == 3.0
    assert entry["worst"]["ratio"] == pytest.approx(0.5)
    assert entry["comparisons"] == 2 * (2 + 1 + 2)


def test_the_finest_order_and_the_control_are_kept_apart(kept):
    assert kept["test_one"]["orders"] == [1.95]
    assert kept["test_one"]["controls"] == ["2 > 1.5"]


def test_a_test_without_numbers_has_an_entry_and_one_of_no_case_none(kept):
    assert kept["test_yes_or_no"]["comparisons"] == 0 and kept["test_yes_or_no"]["worst"] is None
    assert set(kept) == {"test_one", "test_yes_or_no"}
