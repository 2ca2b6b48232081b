"""Progress off a terminal: a line for each finished run, and in long work a line now and then."""

import time

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
        "  limits 1/2 after 2 min, 2 min left",
        "  limits 1/2  check 50% after 3 min, 60 s left",
    ]


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
