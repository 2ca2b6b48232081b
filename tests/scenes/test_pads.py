"""Pads by pattern are the pads of the list that they stand for, with their provenance."""

import copy

from tests.scenes.support import small
from tipoff.scenes import load, parse, provenance

PATTERN = {"stations": ["-0.08 m", "0.08 m"], "corner": ["0.1 m", "+50 mm"], "relief": "20 um"}
LISTED = [
    {
        "position": [x, f"{'-' * (y == '-')}0.1 m", f"{'-' * (z == '-')}50 mm"],
        "normals": [f"{y}y", f"{z}z"],
        "relief": "20 um",
    }
    for x in ("-0.08 m", "0.08 m")
    for y in "-+"
    for z in "-+"
]


def with_pads(pads, **others):
    return parse(small() | {"pads": copy.deepcopy(pads)} | others)


def test_a_pattern_is_its_list():
    pattern, listed = with_pads(PATTERN), with_pads(LISTED)
    assert pattern.pads == listed.pads and pattern.hash == listed.hash
    assert pattern.replace({"pads.5.relief": "9 um"}).pads[5].relief == 9e-6


def test_bare_numbers_are_signed_too():
    listed = with_pads(LISTED)
    pattern = {"stations": [-0.08, 0.08], "corner": [0.1, 0.05], "relief": listed.pads[0].relief}
    raw = listed.resolved() | {"pads": pattern}
    assert parse(raw, bare_numbers_are_si=True).pads == listed.pads


def test_provenance_of_a_key_is_that_of_each_pad():
    texts = {"pads": "assumed", "pads.relief": "drawing", "pads.stations": "CAD"}
    found = with_pads(PATTERN, provenance=texts).provenance
    for pad in range(8):
        assert provenance.nearest(found, f"pads.{pad}.relief") == "drawing"
        assert provenance.nearest(found, f"pads.{pad}.position") == "CAD"
        assert provenance.nearest(found, f"pads.{pad}.length") == "assumed"


def test_a_file_changes_one_key_of_an_inherited_pattern(tmp_path):
    path = tmp_path / "child.toml"
    path.write_text('extends = "reference"\n[pads]\nrelief = "9 um"\n')
    found, base = load(path), load("reference")
    assert [pad.relief for pad in found.pads] == 8 * [9e-6]
    assert [pad.position for pad in found.pads] == [pad.position for pad in base.pads]
    assert provenance.nearest(found.provenance, "pads.3.relief") == "user"
    assert provenance.nearest(found.provenance, "pads.3.length") == "assumed"
