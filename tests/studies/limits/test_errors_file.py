"""Tolerances of a file of errors that keep limits, on a launch without contact, where the total rate is
proportional to the one offset that varies."""

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies import free_flight
from tests.studies.limits import in_memory
from tipoff.lowfi.ensemble.rows import numbers
from tipoff.scenes import halving, uncertainty
from tipoff.studies.cli import app
from tipoff.studies.limits import page, within
from tipoff.studies.limits import stage as limits
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.populations import exceedance
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.render.document import terminal
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

OFFSET = "thrust_offset.eccentricity"
FILE = f"""
cases = 7
sampling = "sobol"
[vary."{OFFSET}.axial"]
distribution = "rayleigh"
scale = "0.2 mm"
[vary."{OFFSET}.radial"]
distribution = "uniform"
low = "0 deg"
high = "360 deg"
[vary."mass_offset.eccentricity.y"]
distribution = "normal"
mean = "0 mm"
sd = "0.1 mm"
[factor."payload.mass"]
distribution = "normal"
mean = "1"
sd = "0.02"
"""
CASES, LIMIT, PROBABILITY = 120, 6.0, 0.9
PER_MM = 1e-3 * free_flight.RATE_PER_METRE


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("errors") / "errors.toml"
    path.write_text(FILE)
    return str(path)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return Study(free_flight.scene(), tmp_path_factory.mktemp("out"), Settings(workers=2))


@pytest.fixture(scope="module")
def options(path):
    limit = f"{LIMIT} deg/s"
    return LimitsOptions(limits=(limit,), probability=PROBABILITY, cases=CASES, vary=path)


@pytest.fixture(scope="module")
def found(study, options):
    with pytest.MonkeyPatch.context() as patch:
        in_memory.keep(patch)
        patch.setattr(
            limits.population, "surrogate", lambda study, *_: Surrogate(study.scene, None, None)
        )
        return limits.run(study, options).result


def certified(rates):
    """The multiple at which the first case that must keep the limit is at the limit, from total rates (n,),
    deg/s, at the tolerances as stated."""
    allowed = exceedance.allowed(CASES, PROBABILITY, 0.95)
    return LIMIT / np.sort(rates)[CASES - 1 - allowed]


def drawn(study, path, names):
    """Inputs (n,) by key of the cases with the tolerances ``names`` as stated."""
    inputs = within.of_file(uncertainty.load(path, study.scene))
    source = inputs.source(study.scene, dict.fromkeys(names, 1.0), CASES, 1)
    return dict(zip(source.keys, numbers(source.keys, source.rows(0, CASES)).T))


def rates(columns):
    """Total rates (n,), deg/s, by hand: both eccentricities are arms of the thrust, mass eccentricity with
    the other sign."""
    zero = np.zeros(CASES)
    r, b, m, c = (
        columns.get(f"{key}.{name}", zero)
        for key in (OFFSET, "mass_offset.eccentricity")
        for name in ("axial", "radial")
    )
    y, z = r * np.cos(b) - m * np.cos(c), r * np.sin(b) - m * np.sin(c)
    return free_flight.RATE_PER_METRE * np.hypot(y, z)


@pytest.mark.case("O49")
@pytest.mark.parametrize("names", [(OFFSET,), (OFFSET, "mass_offset.eccentricity")])
def test_the_certified_multiple_is_the_closed_form(study, found, path, names):
    """Of one offset alone, and of the whole file, whose mass changes no rate. Control: the multiple of the
    other inputs."""
    row = found.rows[0] if len(names) == 1 else found.rows[-1]
    assert row.name == (OFFSET if len(names) == 1 else "together")
    exact = certified(rates(drawn(study, path, names)))
    # the search stops within 1.1 %; the steps have an error of a thousandth
    assert 1.0 / 1.013 < row.nominal.tolerance / exact < 1.002
    other = found.rows[-1 if len(names) == 1 else 0].nominal.tolerance
    assert not 1.0 / 1.013 < other / exact < 1.002


def test_the_share_as_stated_and_the_range_at_the_certified_multiple(study, found, path):
    row = found.rows[0]
    above = int((rates(drawn(study, path, (OFFSET,))) > LIMIT).sum())
    assert row.advised.above == above > 0 and row.advised.tolerance == 1.0
    high = 0.2 * np.sqrt(-2.0 * np.log(0.05))  # mm, of a Rayleigh distribution
    assert row.stated == f"axial 0 to {high:.3g} mm" or row.stated == f"0 to {high:.3g} mm"
    assert row.certified.endswith(f"0 to {row.nominal.tolerance * high:.3g} mm")


def test_an_input_of_another_tolerance_is_that_of_the_scene(study, found, path):
    """Every row has the inputs of its own tolerance, and all cases those of the options: the number of cases
    and the sampling of the file are not used."""
    assert drawn(study, path, ("payload.mass",)).keys() == {"payload.mass"}
    assert [row.name for row in found.rows] == [
        *halving.tolerances(uncertainty.load(path, study.scene)),
        "together",
    ]
    mass = next(row for row in found.rows if row.name == "payload.mass")
    assert mass.nominal.state == "all" and mass.stated == "0.961 to 1.04 times"
    assert found.cases == CASES and found.map is None


def test_a_tolerance_of_zero_is_the_middle_of_each_input(study, path):
    inputs = within.of_file(uncertainty.load(path, study.scene))
    source = inputs.source(study.scene, dict.fromkeys(inputs.factors, 0.0), 3, 1)
    row = source.rows(0, 1)[0]
    assert row["payload.mass"] == 10.0
    assert row[f"{OFFSET}.axial"] == row["mass_offset.eccentricity.axial"] == 0.0


def test_the_section_has_the_file_and_no_advice_of_the_paper(found, path):
    shown = terminal(page.draw(found))
    assert "its range" in shown and "as stated" in shown and "times as stated" in shown
    assert path in " ".join(shown.split()) or path in shown.replace("\n", "")
    assert "paper" not in shown


def test_a_file_without_scatter_and_an_unknown_one_are_refused(tmp_path):
    fixed = tmp_path / "fixed.toml"
    fixed.write_text('[vary."payload.mass"]\ndistribution = "fixed"\nvalue = "10 kg"\n')
    for vary, words in ((str(fixed), "a distribution with a scatter"), ("papr", "paper")):
        arguments = [
            "limits",
            "--out",
            str(tmp_path / "out"),
            "--vary",
            vary,
            "--limit",
            "q=1 deg/s",
        ]
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 2 and words in result.stderr and "--limit" in result.stderr
    assert not (tmp_path / "out").exists()
