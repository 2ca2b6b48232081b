"""Cases, controls and answers are read from the source of a test."""

import textwrap

from tests.verification import reading

SOURCE = '''
    import pytest
    from tests.exact import contact as exact
    from tests.somewhere import STEEL, measure

    MASS = 2.0 * 3.0


    @pytest.mark.case("O1")
    def test_one(step):
        """A sentence. Control: the weak method is off."""
        answer = exact.answer(MASS, **STEEL)
        found = measure(MASS, step)
        filled = []
        for _ in range(3):
            filled.append(found)
        assert filled == pytest.approx([answer] * 3)
        assert answer == pytest.approx(6.0)
        assert found == pytest.approx(answer)
        # Control: half the steps
        # are too few.
        assert measure(MASS, 2 * step) > 7.0
        # what follows is no control
        assert found > 5.0


    @pytest.mark.slow
    @pytest.mark.case("O2")
    @pytest.mark.case("X1")
    def test_a_weaker_method_is_off():
        """Control."""
        assert measure(MASS, 1.0) > 1.0


    def test_of_no_case():
        pass
    '''


def read(tmp_path):
    path = tmp_path / "test_made_up.py"
    path.write_text(textwrap.dedent(SOURCE))
    return path.read_text().splitlines(), reading.tests(path)


def test_cases_and_controls(tmp_path):
    _, found = read(tmp_path)
    assert {name: test.cases for name, test in found.items()} == {
        "test_one": ("O1",),
        "test_a_weaker_method_is_off": ("O2", "X1"),
    }
    assert found["test_one"].controls == (
        "Half the steps are too few.",
        "The weak method is off.",
    )
    assert found["test_a_weaker_method_is_off"].controls == ("A weaker method is off.",)


def test_asserts_below_the_comment_belong_to_the_control(tmp_path):
    lines, found = read(tmp_path)
    controls = [
        line for number, line in enumerate(lines, 1) if found["test_one"].is_control(number)
    ]
    assert [line.strip() for line in controls] == ["assert measure(MASS, 2 * step) > 7.0"]
    whole = found["test_a_weaker_method_is_off"]
    assert any("> 1.0" in line and whole.is_control(n) for n, line in enumerate(lines, 1))


def test_a_closed_form_beside_its_tabulated_value_is_no_result(tmp_path):
    """Control: a result beside the closed form is one."""
    lines, found = read(tmp_path)
    number = {line.strip(): count for count, line in enumerate(lines, 1)}
    alone = found["test_one"].compares_answers_alone
    assert alone(number["assert answer == pytest.approx(6.0)"])
    assert not alone(number["assert found == pytest.approx(answer)"])
    assert not alone(number["assert filled == pytest.approx([answer] * 3)"])


def test_every_marked_test_of_the_project_is_read():
    """Those of the table of cases too."""
    found = {case for test in reading.all_tests() for case in test.cases}
    assert {"O1", "O52", "X8", "X19"} <= found
