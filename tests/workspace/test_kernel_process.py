"""The kernels of a run are compiled in a process of their own while the statics of its rails are solved."""

import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import nullcontext

import numba
import pytest

from tests.lowfi.compliance import REFERENCE
from tipoff import lowfi, scenes
from tipoff.calibration import rail_compliance
from tipoff.highfi import compliance
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics.rail_compliance import DEGREE, LOW_DEGREE, RailCompliance
from tipoff.scenes import parse
from tipoff.studies.populations import population
from tipoff.workspace import kernel_marks, kernel_process, machine
from tipoff.workspace.kernel_process import compiled_beside
from tipoff.workspace.run import Run
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

JOINTS = {"rail.mount_stiffness": {"normal": 1e11, "shear": 1e11}}
WAITING = "import time; time.sleep(600)"


@pytest.fixture
def started(monkeypatch, tmp_path):
    """Processes that were started; there are two cores and no kernels. Each is a process of
    Python that runs the text ``started.code``."""

    class Started(list):
        code = ""

    made, start = Started(), subprocess.Popen

    def instead(line, **further):
        assert line[:2] == [sys.executable, "-c"]
        made.append(start([*line[:2], made.code], **further))
        return made[-1]

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(machine, "cores", lambda: 2)
    monkeypatch.setattr(subprocess, "Popen", instead)
    return made


def is_there(process) -> bool:
    """Whether the process is running, or ended and not yet taken from the table of processes."""
    return os.path.exists(f"/proc/{process.pid}")


def kernel_types(run: Run, walls: RailCompliance | None = None, modes: int = 0) -> list:
    """Types of the arguments of the time loop: they decide which kernel runs."""
    numerics = lowfi.Numerics(modes=modes)
    single = SingleRun(run.scene, numerics, walls or run.compliance, watches=True)
    return [numba.typeof(argument) for argument in single.arguments(0)]


@pytest.mark.parametrize("changes", [{}, JOINTS, {"thermal.mean": 20.0}])
def test_walls_that_do_not_yield_need_the_kernels_of_those_that_do(changes):
    """With modes too. Control: patterns of another degree need others."""
    scene = REFERENCE.replace(changes)
    ours, theirs = kernel_process.request(scene), compliance.condense(scene, 8e-3)
    assert ours.model == "compliant"
    assert kernel_types(ours) == kernel_types(ours, theirs) == kernel_types(ours, theirs, modes=1)
    assert kernel_types(ours) != kernel_types(ours, theirs.of_degree(LOW_DEGREE))


def test_the_process_runs_during_the_block_and_leaves_a_mark(started, capfd):
    """Control: the next block finds the mark, and starts nothing."""
    for count in (1, 1):
        with compiled_beside(REFERENCE, 2):
            assert len(started) == count
        assert kernel_marks.are_there(kernel_process.request(REFERENCE))
    assert capfd.readouterr().err.count("compiling the kernels of model compliant") == 1
    assert not is_there(started[0])


def test_the_process_gets_the_scene(started, tmp_path):
    scene = REFERENCE.replace(JOINTS | {"rail.mount_stiffness.factor": 2.0})
    started.code = f"import sys; open('{tmp_path}/given', 'w').write(sys.stdin.read())"
    with compiled_beside(scene, 2):
        pass
    described, degree = json.loads((tmp_path / "given").read_text())
    given = parse(described, bare_numbers_are_si=True)
    assert degree == DEGREE
    assert given.hash == REFERENCE.replace(JOINTS).hash  # the factor changes no kernel


@pytest.mark.parametrize("condition", [None, "phi35"])
def test_a_population_compiles_the_kernels_of_its_cases(condition, monkeypatch, tmp_path):
    """Its cases have fewer patterns than the compliance. Control: a run."""
    asked = []

    def beside(scene, workers, patterns):
        asked.append(patterns)
        return nullcontext()

    monkeypatch.setattr("tipoff.workspace.study.compiled_beside", beside)
    monkeypatch.setattr(rail_compliance, "kept", lambda *_: None)
    study = Study(REFERENCE, tmp_path, Settings())
    population.surrogate(study, "compliant", condition)
    study.rail_compliance(REFERENCE)
    assert asked == [LOW_DEGREE, DEGREE]


@pytest.mark.parametrize("code", ["raise SystemExit(3)", "import os; os.abort()", "?"])
def test_a_process_that_fails_is_harmless(started, code):
    started.code = code
    with compiled_beside(REFERENCE, 2):
        pass
    assert not kernel_marks.are_there(kernel_process.request(REFERENCE))
    assert not is_there(started[0])


@pytest.mark.parametrize("error", [KeyboardInterrupt, ZeroDivisionError])
def test_an_interrupt_ends_the_process(started, error):
    started.code = WAITING
    with pytest.raises(error), compiled_beside(REFERENCE, 2):
        raise error
    assert started[0].returncode == -signal.SIGKILL and not is_there(started[0])


def test_an_interrupt_while_it_is_awaited_ends_the_process(started):
    # a shell's background process ignores this signal
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    started.code = WAITING
    main = threading.main_thread().ident
    interrupt = threading.Timer(0.3, signal.pthread_kill, (main, signal.SIGINT))
    try:
        with pytest.raises(KeyboardInterrupt), compiled_beside(REFERENCE, 2):
            interrupt.start()
    finally:
        signal.signal(signal.SIGINT, before)
    assert started[0].returncode == -signal.SIGKILL and not is_there(started[0])


@pytest.mark.parametrize("workers, cores", [(1, 2), (2, 1)])
def test_one_core_does_one_thing_after_another(started, monkeypatch, workers, cores):
    monkeypatch.setattr(machine, "cores", lambda: cores)
    with compiled_beside(REFERENCE, workers):
        pass
    assert not started


def test_a_rail_from_a_file_has_the_same_kernels(started):
    """Also where its walls are not straight."""
    with compiled_beside(scenes.load("channel"), 2):
        pass
    assert len(started) == 1
    with compiled_beside(REFERENCE, 2):
        pass
    assert len(started) == 1


@pytest.mark.parametrize("model, count", [("compliant", 1), ("springs", 0)])
def test_a_study_starts_it_only_for_a_new_compliance_of_compliant_contact(
    started, tmp_path, model, count
):
    """Warm rails of springs need the statics too, but not these kernels."""
    scene = scenes.load("tiny").replace({"thermal.mean": 20.0})
    study = Study(scene, tmp_path / "out", Settings(element_size=8e-3, workers=2))
    for _ in range(2):
        asked = study.rail_compliance if model == "compliant" else study.rigid_rails
        assert asked(scene) is not None
        assert len(started) == count


@pytest.mark.slow
def test_it_leaves_the_kernels_of_a_run(monkeypatch, tmp_path, capfd):
    """The time loop of a later run is the one that the process compiled."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(machine, "cores", lambda: 2)
    with compiled_beside(REFERENCE, 2):
        pass
    assert len(list(tmp_path.glob("kernels/*integrate*/integrate.integrate-*.nbc"))) == 1
    made = "from tipoff import lowfi; from tests.lowfi.compliance import *; lowfi.run(REFERENCE, "
    made += "compliance=reference_compliance(), numerics=lowfi.Numerics(modes=0))"
    subprocess.run([sys.executable, "-c", made], check=True)
    assert len(list(tmp_path.glob("kernels/*integrate*/integrate.integrate-*.nbc"))) == 1
