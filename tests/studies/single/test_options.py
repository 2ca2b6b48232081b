"""Options of ``tipoff run`` that are numerics reach the run."""

import json

import pytest

from tests.studies.test_first_steps import call


@pytest.mark.parametrize(
    "options, numerics",
    [
        (
            ["--degree", "2", "--cells", "12", "--modes", "1"],
            {"degree": 2, "cells": 12, "modes": 1},
        ),
        (["--degree", "auto", "--modes", "0"], {"cells": 16, "modes": 0}),
    ],
)
def test_numerics_of_the_command_are_those_of_the_run(options, numerics, tmp_path):
    """A chosen degree is stated with its reason."""
    found = call("run", "--scene", "tiny", "--out", str(tmp_path), "--json", *options)
    given = json.loads(found.stdout)["numerics"]
    assert {name: given[name] for name in numerics} == numerics
    assert ("degree_why" in given) == ("auto" in options)


@pytest.mark.parametrize(
    "command, faults",
    [
        ("run --range --model springs --degree 2", ["--model", "--degree"]),
        ("run --range --calibration c.toml --cells 8", ["--calibration", "--cells"]),
        ("run --range --budget 1s", ["--budget"]),
        ("run --explain --json", ["--explain"]),
        (
            "run --all --condition phi15 --model springs --modes 2 --range --explain",
            ["--condition", "--model", "--modes", "--range", "--explain"],
        ),
        ("run --all --checkpoint-every 1s", ["--checkpoint-every"]),
        ("compare --vary paper --seed 3", ["--vary", "--seed"]),
        ("ensemble --table t.csv --vary paper --cases 3 --halve", ["vary", "cases", "halve"]),
        (
            "ensemble --case 1 --at exit --limit 1 --scheduler tcp://a:1 --export csv a.csv",
            ["--at", "--limit", "--scheduler", "--export"],
        ),
        ("curves a=a.csv --model finite-elements --calibration c.toml", ["--model"]),
    ],
)
def test_an_option_without_effect_is_refused(command, faults, tmp_path):
    """Every one of them."""
    found = call(*command.split(), "--scene", "tiny", "--out", tmp_path)
    assert found.exit_code == 2
    assert all(f"{name}: " in found.stderr for name in faults), found.stderr


def test_a_degree_that_no_pattern_has_is_refused():
    assert "1, 2, 3, 4, 5, or auto" in call("run", "--scene", "tiny", "--degree", "6").output
