"""Errors that come back from another process say what they said there."""

from concurrent.futures import ProcessPoolExecutor

from tipoff.faults import Fault, SceneError
from tipoff.files import DamageError
from tipoff.highfi.dynamics.checkpoint import CheckpointError

ERRORS = (
    SceneError([Fault("a", "b", "1 m", "2 m"), Fault("a", "c", "nothing", "this key")]),
    CheckpointError("run.npz", "is damaged"),
    DamageError("run.npz", "is damaged"),
)


def fail(number: int):
    raise ERRORS[number]


def test_errors_come_back_from_a_process_as_they_were():
    with ProcessPoolExecutor(1) as pool:
        for number, error in enumerate(ERRORS):
            again = pool.submit(fail, number).exception()
            assert type(again) is type(error)
            assert str(again) == str(error) and vars(again) == vars(error)
