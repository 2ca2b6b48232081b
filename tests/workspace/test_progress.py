"""Progress off a terminal: a line for each finished run, and in long work a line now and then."""

import time

from tipoff.remaining import Remaining
from tipoff.workspace.progress import Board


def test_long_work_off_a_terminal_says_how_far_it_is(monkeypatch, capsys):
    """Without a terminal there is no bar. Studies of minutes were silent there until their end."""
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    with Board("limits", 2) as board:
        report = board.callback("search")
        for taken, share in (
            (0.0, 0.0),
            (9.9, 0.1),
            (10.0, 0.25),
            (29.0, 0.5),
            (30.0, 0.75),
            (69.0, 0.8),
        ):
            now[0] = 100.0 + taken
            report(share)
        now[0] = 180.0
        board.finished("search", "done")
        for taken, share in ((119.0, 0.0), (120.0, 0.0), (179.0, 0.5), (180.0, 0.5)):
            now[0] = 100.0 + taken
            board.callback("check")(share)
    assert capsys.readouterr().err.splitlines() == [
        "  limits 0/2  search 25% after 10 s, 70 s left",
        "  limits 0/2  search 75% after 30 s, 50 s left",
        "  limits 1/2  search: done",
        "  limits 1/2 after 2 min, 6 min left",  # an eighth in the last 90 s
        "  limits 1/2  check 50% after 3 min, 60 s left",
    ]


def test_a_share_that_falls_begins_another_part(monkeypatch, capsys):
    """Of unknown length: there is no time left to state. Control: a run that only grows has one."""
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    for title, shares in (("falls", (0.5, 1.0, 0.02, 0.07)), ("grows", (0.2, 0.5, 0.6, 0.7))):
        now[0] = 0.0
        with Board(title, 1) as board:
            report = board.callback("nominal")
            for taken, share in zip((1.0, 9.0, 9.5, 10.0), shares):
                now[0] = taken
                report(share)
    assert capsys.readouterr().err.splitlines() == [
        "  falls 0/1  nominal, part 2 7% after 10 s",
        "  grows 0/1  nominal 70% after 10 s, 4 s left",
    ]


def test_the_last_minute_counts_and_wrong_estimates_are_admitted():
    """Work that slows down: fast to 90 %, then a hundredth in each minute. Control: the mean speed since the
    start says much less."""
    left = Remaining(0.0)
    for at in range(1, 10):
        left.note(float(at), 0.1 * at)
    assert left.words(9.0) == "1 s left"
    said = []
    for minute in range(1, 6):
        left.note(9.0 + 60.0 * minute, 0.9 + 0.01 * minute)
        said.append(left.words(9.0 + 60.0 * minute))
    assert said[-1] == "5 min left" and 309.0 * 0.05 / 0.95 < 20.0
    stuck = Remaining(0.0, 0.5)
    stuck.note(10.0, 0.9)
    assert stuck.words(10.0) == "2 s left"
    stuck.note(20.0, 0.91)
    assert stuck.words(20.0) == "4 s left"
    stuck.note(100.0, 0.92)
    assert stuck.words(100.0).endswith("left; earlier estimates were too short")
    stuck.note(200.0, 0.92)
    assert stuck.words(200.0) == ""  # nothing is done in the last minute


def test_a_line_names_a_few_of_many_runs(monkeypatch, capsys):
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    with Board("kernels", 8) as board:
        for name in "abcde":
            board.callback(name)(0.5)
        board.callback("waiting")(0.0)
        now[0] = 12.0
        board.callback("e")(0.5)
    assert (
        capsys.readouterr().err
        == "  kernels 0/8  a 50%, b 50%, c 50% and 2 more after 12 s, 26 s left\n"
    )


def test_short_work_says_nothing_but_its_end(capsys):
    with Board("run", 1) as board:
        board.callback("nominal")(0.5)
        board.finished("nominal", "exited")
    assert capsys.readouterr().err == "  run 1/1  nominal: exited\n"
