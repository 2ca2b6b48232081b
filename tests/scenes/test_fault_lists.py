"""A message lists three faults of a kind and counts the others."""

import pytest

from tests.scenes.support import refused, small, write
from tipoff.faults import Fault, SceneError, close, kind_of
from tipoff.formats import csv_file
from tipoff.scenes import parse


def test_a_bad_column_is_a_short_message(tmp_path):
    rows = "".join(f"{line},{line} N\n" for line in range(20_000))
    path = write(tmp_path, "curve.csv", "time_s,force_N\n" + rows)
    (fault,) = refused(small(thrust={"kind": "measured", "file": str(path)}))
    assert len(str(fault)) < 1000 and "'2 N' in line 4" in str(fault)
    assert "19994 more" in str(fault)
    _, *rows = csv_file.listed(path)
    faults = csv_file.numbers(str(path), "force_N", 1, rows)[1]
    assert len(faults) == 4 and len(str(SceneError(faults))) < 1000


def test_a_long_cell_is_cut(tmp_path):
    path = write(tmp_path, "a.csv", f"a,b\n1,2\n{'x' * 100_000},1\n")
    _, *rows = csv_file.listed(path)
    faults = csv_file.numbers(str(path), "a", 0, rows)[1]
    assert len(str(SceneError(faults))) < 300


@pytest.mark.parametrize("count, lines", [(3, 4), (4, 5), (20_000, 5)])
def test_faults_that_differ_in_numbers_are_one_kind(count, lines):
    faults = [
        Fault("cases.csv", f"line {place}, payload.mass", f"{place} m", f"kg, at most {place}")
        for place in range(count)
    ]
    error = SceneError(faults)
    assert len(str(error).splitlines()) == lines and len(error.faults) == count
    assert f"{count - 3:,} more" in str(error) or count == 3


def named(number: int) -> str:
    """A name of letters alone."""
    return "".join(chr(97 + number // 26**place % 26) for place in range(3))


def test_names_of_the_user_make_no_kind_of_their_own():
    """5000 conditions with one mistake: three places and a count. Control: two mistakes are two kinds."""
    wrong = {f"c{named(k)}": {"payload.mass": f"{k} m"} for k in range(4999)}
    with pytest.raises(SceneError) as caught:
        parse(small(conditions=wrong))
    assert len(caught.value.faults) == 4999 and len(str(caught.value).splitlines()) == 5
    assert "and 4,996 more of this kind" in str(caught.value)
    wrong["caaa"]["payload.mas"] = "1 kg"
    assert any("payload.mas:" in line for line in str(refusal(conditions=wrong)).splitlines())


def test_a_message_has_a_bounded_number_of_lines():
    """5000 unknown keys, each of which may be another mistake. Control: forty are all listed."""
    message = str(refusal(**{f"key{named(k)}": 1 for k in range(5000)}))
    assert len(message) < 3000 and "and 4,960 more lines" in message
    message = str(refusal(**{f"key{named(k)}": 1 for k in range(40)}))
    assert "more" not in message and len(message.splitlines()) == 41


def refusal(**tables) -> SceneError:
    with pytest.raises(SceneError) as caught:
        parse(small(**tables))
    return caught.value


def test_faults_of_other_kinds_are_all_listed():
    """Control."""
    faults = [Fault("a.toml", f"payload.{chr(97 + k)}", "1 m", "kg") for k in range(20)]
    assert len(str(SceneError(faults)).splitlines()) == 21


@pytest.mark.parametrize("key", ["agreement.settled_limit", "studies.neighbours"])
def test_a_condition_has_no_keys_of_the_whole_scene(key):
    """They would have no effect there. Control: a key of its tables."""
    found = {fault.key: fault.expected for fault in refused(small(conditions={"phi15": {key: 3}}))}
    assert "a key of the scene itself" in found[f"conditions.phi15.{key}"]
    parse(small(conditions={"phi15": {"payload.mass": "9 kg"}}))


def test_a_name_that_is_there_twice_is_suggested_once_and_never_for_itself():
    assert close("forse", ["time", "force", "force"]) == ", did you mean force?"
    assert close("force", ["time", "force", "force"]) == ""


def test_kinds_have_their_article():
    assert [kind_of(each) for each in (1, "x", None)] == ["an int", "a str", "None"]
