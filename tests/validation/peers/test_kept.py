"""Today's numbers against those of other codes, which are kept where these codes are not installed."""

import pytest

from tipoff.files import read_json
from validation.documents import peers as document
from validation.peers import stage
from validation.peers.case import PeerMissing

KEPT = {
    case["name"]: case
    for path in sorted(stage.KEPT.glob("*.json"))
    for case in read_json(path)["cases"]
}
CASES = {case.name: case for peer in stage.PEERS for case in peer.cases()}
# Cases whose set of effects no other quick test has: each kernel takes ten seconds to compile. Quick
# tests compare the same laws with CalculiX (events), with quadratic elements and with Exudyn.
OWN_KERNEL = ("calculix-impact", "mujoco-linear", "mujoco-friction")
SETTINGS = [
    pytest.param(
        case.name,
        setting,
        id=f"{case.name}: {setting}",
        marks=[pytest.mark.slow] if setting in case.slow or case.name in OWN_KERNEL else [],
    )
    for case in CASES.values()
    for setting in case.settings
]


def beyond(case, rows, values) -> list[str]:
    """Quantities of ``values`` that are farther from the peer's in ``rows`` than the case allows."""
    replaced = [row | {"ours": values[row["quantity"]]} for row in rows]
    largest = {row["quantity"]: 0.0 for row in rows}
    for row in KEPT[case.name]["rows"]:
        largest[row["quantity"]] = max(largest.get(row["quantity"], 0.0), abs(row["theirs"]))
    return [
        row["quantity"]
        for row in replaced
        if not abs(row["ours"] - row["theirs"])
        <= case.within(row["setting"], row["quantity"]) * largest[row["quantity"]]
    ]


def kept_rows(case, setting) -> list[dict]:
    return [row for row in KEPT[case.name]["rows"] if row["setting"] == setting]


@pytest.mark.case("O80")
@pytest.mark.parametrize(("name", "setting"), SETTINGS)
def test_what_another_code_found_is_found_here(name, setting):
    case = CASES[name]
    rows = kept_rows(case, setting)
    assert rows
    found = case.ours(setting)
    assert {row["quantity"] for row in rows} == set(found) - {"cpu_s"}
    assert beyond(case, rows, found) == []


@pytest.mark.slow
@pytest.mark.parametrize("peer", stage.PEERS, ids=lambda peer: peer.name)
def test_a_code_that_is_installed_finds_what_was_kept(peer):
    """The same version, or one that computes the same: six digits of the first setting."""
    try:
        peer.version()
    except PeerMissing as missing:
        pytest.skip(str(missing))
    case = peer.cases()[0]
    found = case.theirs(case.settings[0])
    for row in kept_rows(case, case.settings[0]):
        assert found[row["quantity"]] == pytest.approx(row["theirs"], rel=1e-6)


@pytest.mark.parametrize("name", CASES)
def test_a_value_beyond_the_limit_is_seen(name):
    """Control: the peer's own values pass, values moved by one and a half limits do not."""
    case = CASES[name]
    for setting in case.settings:
        rows = kept_rows(case, setting)
        exact = {row["quantity"]: row["theirs"] for row in rows}
        assert beyond(case, rows, exact) == []
        largest = {
            row["quantity"]: max(
                abs(other["theirs"])
                for other in KEPT[name]["rows"]
                if other["quantity"] == row["quantity"]
            )
            for row in rows
        }
        moved = {
            quantity: value + 1.5 * case.within(setting, quantity) * largest[quantity]
            for quantity, value in exact.items()
        }
        assert beyond(case, rows, moved) == list(exact)


def test_kept_results_are_those_of_the_present_cases():
    assert set(KEPT) == set(CASES)
    for name, case in CASES.items():
        kept = KEPT[name]
        assert kept["inputs"] == dict(case.inputs())
        assert tuple(dict.fromkeys(row["setting"] for row in kept["rows"])) == case.settings
        assert {row["quantity"]: row["unit"] for row in kept["rows"]} == dict(case.units)


def test_a_softer_rail_is_seen():
    """Control: one per cent of the stiffness moves what equal elements agree on to 1e-6."""
    case = CASES["calculix-load"]
    setting = case.settings[0]
    found = case.ours(setting)
    softer = found | {"deflection": found["deflection"] / 0.99}
    assert beyond(case, kept_rows(case, setting), softer) == ["deflection"]


def test_the_page_is_that_of_the_kept_results():
    assert document.text() == (document.DOCS / "peers.md").read_text()
