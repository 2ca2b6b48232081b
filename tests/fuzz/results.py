"""Mutants of files that one command writes and another reads: rail compliance, runs, checkpoints, results
of stages, stores of ensembles, sources. Half of them have a digest that fits, as a file of another version
of the program has, so that what is behind the check of the digest is reached as well."""

import hashlib
import io
import json
import random
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.fuzz import mutants
from tests.studies import synthetic
from tipoff import files, scenes
from tipoff.calibration import rail_compliance
from tipoff.comparison import metrics
from tipoff.faults import Fault, SceneError
from tipoff.highfi.dynamics.checkpoint import Checkpoint, CheckpointError, restore
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.store import CHUNK, Chunk, Store, StoreError
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory, content
from tipoff.scenes.rail_compliance import of_scene
from tipoff.studies.agreement import other_rails
from tipoff.studies.calibration import forecast
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.limits import constants
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, read
from validation.bench import reference
from validation.peers import stage as peers

Rng = random.Random
COARSE = 8e-3  # m


def _refused(file: Path, fault: BaseException) -> SceneError:
    """A refusal by an exception of the Python interface, which must name the file."""
    if not str(fault).startswith(str(file)):
        raise fault
    return SceneError([Fault(str(file), "file", str(fault), "a whole one")])


def _sealed(rng: Rng, content: bytes) -> bytes:
    """Half of the contents with their digest as the last line."""
    if rng.random() < 0.5:
        content += b"# sha-256 " + hashlib.sha256(content).hexdigest().encode() + b"\n"
    return content


def _array(rng: Rng, old: np.ndarray) -> np.ndarray:
    """Another shape, type or number in place of an array."""
    flat = old.reshape(-1)
    spoiled = np.array(old)
    if spoiled.size and spoiled.dtype.kind in "fiu":
        number = rng.choice((np.nan, np.inf, -1.0, 0.0, 1e300, 2**62))
        with suppress(OverflowError, ValueError):
            spoiled.reshape(-1)[rng.randrange(spoiled.size)] = number
    others: list[Callable[[], np.ndarray]] = [
        lambda: spoiled,
        lambda: spoiled,
        lambda: flat,
        lambda: flat[:1],
        lambda: flat[:0],
        lambda: old[None],
        lambda: old.T,
        lambda: old[: len(old) // 2] if old.ndim else old[None],
        lambda: np.array(rng.choice((0.0, -1, "x", b"x", 1j, True))),
        lambda: old.astype(rng.choice(("f4", "c16", "U9", "i1", "M8[s]", "?"))),
    ]
    with np.errstate(all="ignore"):
        try:
            return rng.choice(others)()
        except (ValueError, TypeError):
            return flat[:1]


def _arrays(rng: Rng, arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Arrays of which one to four are others, or have other names, or are missing."""
    arrays = dict(arrays)
    for _ in range(rng.choice(mutants.EDITS)):
        name = rng.choice(list(arrays))
        if rng.random() < 0.2:
            arrays[rng.choice((name, "other"))] = arrays.pop(name)
        elif rng.random() < 0.2 and len(arrays) > 1:
            del arrays[name]
        else:
            arrays[name] = _array(rng, arrays[name])
    return arrays


def _compliance(rng: Rng, folder: Path) -> None:
    file = folder / "rail.npz"
    if rng.random() < 0.6:
        stream = io.BytesIO()
        np.savez(stream, allow_pickle=False, **_arrays(rng, _kept_compliance()))
        content = stream.getvalue()
    else:
        stream = io.BytesIO()
        np.savez(stream, allow_pickle=False, **_kept_compliance())
        content = mutants.of_bytes(rng, stream.getvalue())
    file.write_bytes(_sealed(rng, content))
    try:
        found = RailCompliance.load(file)
    except ValueError as fault:
        raise _refused(file, fault) from None
    scene = _stiffened(rng.choice((1.0, 1.5)))
    of_scene(found, scene).cubic()
    found.rigid().summary()


@cache
def _stiffened(factor: float) -> scenes.Scene:
    scene = scenes.load("tiny")
    table = {"normal": "1e12 N/m**3", "shear": "1e12 N/m**3", "factor": factor}
    return scene.replace({"rail.mount_stiffness": table})


@cache
def _kept_compliance() -> dict[str, np.ndarray]:
    with tempfile.TemporaryDirectory() as folder:
        rail_compliance.compliance(_stiffened(1.0), COARSE).save(f"{folder}/rail.npz")
        with np.load(f"{folder}/rail.npz", allow_pickle=False) as found:
            return dict(found)


def _run(rng: Rng, folder: Path) -> None:
    file = folder / "lowfi" / "run-springs-12345678.nc"
    file.parent.mkdir()
    if rng.random() < 0.6:
        content = _other_netcdf(rng, _kept_run(), folder)
    else:
        content = mutants.of_bytes(rng, _kept_run())
    file.write_bytes(_sealed(rng, content))
    (folder / "highfi").mkdir()
    shutil.copy(file, folder / "highfi" / file.name)
    study = Study(scenes.load("tiny"), folder, defaults("tiny"))
    assert forecast.pace(study).ns > 0.0
    assert forecast.search(study, 2)
    try:
        found = Trajectory.load(file)
    except OSError as fault:
        raise _refused(file, fault) from None
    found.to_xarray()
    found.summary()
    metrics.compare(found, found)


def _other_netcdf(rng: Rng, content: bytes, folder: Path) -> bytes:
    """A file of netCDF with one to four other arrays or attributes."""
    place = folder / "work.nc"
    place.write_bytes(content)
    with h5py.File(place, "r+") as data:
        for _ in range(rng.choice(mutants.EDITS)):
            if rng.random() < 0.5:
                name = rng.choice(list(data))
                old = np.asarray(data[name][()])
                del data[name]
                with suppress(TypeError):
                    if rng.random() < 0.8:
                        data[name] = _array(rng, old)
            else:
                name = rng.choice(list(data.attrs))
                text = str(data.attrs[name])
                del data.attrs[name]
                if rng.random() < 0.8:
                    data.attrs[name] = _attribute(rng, text)
            if not list(data) or not list(data.attrs):
                break
    return place.read_bytes()


def _attribute(rng: Rng, text: str) -> Any:
    how = rng.randrange(5)
    if how == 0:
        return rng.choice((1.0, "x", "", "{}", "[]", "null", "NaN", "1", '"x"', b"\xff"))
    if how == 1:
        return mutants.of_text(rng, text).replace("\0", "")
    try:
        return json.dumps(mutants.of_plain(rng, json.loads(text)))
    except ValueError:
        return text[:3]


@cache
def _kept_run() -> bytes:
    return bytes(content(synthetic.flight(samples=61)))


def _checkpoint(rng: Rng, folder: Path) -> None:
    loop, arrays, path = *_begun(), folder / "run.checkpoint"
    kept = Checkpoint(path, 0.0, loop, _numerics())
    stream = io.BytesIO()
    if rng.random() < 0.6:
        arrays = _arrays(rng, arrays)
    np.savez(stream, allow_pickle=False, **arrays)
    content = stream.getvalue()
    if rng.random() < 0.4:
        content = mutants.of_bytes(rng, content)
    files.write_sealed(path, content)
    if rng.random() < 0.3:
        path.write_bytes(mutants.of_bytes(rng, path.read_bytes()))
    try:
        saved = kept.read()
        assert saved is not None
        kept.resume(loop, saved)
    except CheckpointError as fault:
        raise _refused(path, fault) from None
    finally:
        restore(loop, _begun()[1])


def _numerics():
    from tipoff import highfi

    return highfi.Numerics(element_size=COARSE)


@cache
def _begun() -> tuple[Any, dict[str, np.ndarray]]:
    """A run of the reference at its beginning, and the arrays of its checkpoint."""
    from tests.highfi.support import begun

    loop = begun(numerics=_numerics())
    with tempfile.TemporaryDirectory() as folder:
        kept = Checkpoint(f"{folder}/run", 0.0, loop, _numerics())
        kept.write(loop)
        with np.load(kept.path, allow_pickle=False) as archive:
            return loop, dict(archive)


STAGES = ("calibration.json", "agreement.json", "bench/highfi.json", "bench/lowfi.json")


def _stage(rng: Rng, folder: Path) -> None:
    """Results of stages in the folder of a scene and in those beside it."""
    name = rng.choice(STAGES)
    own = folder / "tiny"
    for other in ("reference", "tiny", "bench", "peers"):
        (folder / other).mkdir()
    found = _changed_json(rng, _stage_result())
    for place in (own / name.rpartition("/")[2], folder / "reference" / "agreement.json"):
        place.write_bytes(found)
    (own / "calibration.json").write_bytes(_changed_json(rng, _stage_result()))
    (folder / "bench" / "highfi.json").write_bytes(found)
    (folder / "peers" / f"{peers.PEERS[0].name.lower()}.json").write_bytes(found)
    study = Study(scenes.load("tiny"), own, defaults("tiny"))
    forecast.pace(study)
    other_rails.beside(folder / "channel")
    calibrate.stored(study)
    constants.margin(study, "springs")
    reference.stored(folder)
    with suppress(KeyError):
        calibrate.constants(study)
    study.stage("agreement", "some key", lambda: ({}, []))
    try:
        peers.stored(folder / "peers")
    except files.DamageError as fault:
        raise _refused(fault.path, fault) from None
    if read(own / "calibration.json") is None:
        raise SceneError([Fault("calibration.json", "file", "damaged", "a whole one")])


def _changed_json(rng: Rng, value: dict) -> bytes:
    """JSON of another value, half of it with a digest that fits."""
    changed = mutants.of_plain(rng, json.loads(json.dumps(value)))
    if rng.random() < 0.5 and isinstance(changed, dict):
        with suppress(ValueError):
            return json.dumps(files.with_digest(changed)).encode()
    return mutants.of_text(rng, json.dumps(changed, indent=1)).encode("utf-8", "surrogatepass")


def _stage_result() -> dict:
    """What the results of stages have in common, and the fields that are read without their key."""
    return {
        "stage": "agreement",
        "scene": "tiny",
        "key": "some key",
        "asked": None,
        "element_size_m": 4e-3,
        "constants": {"contact.stiffness": 2.2e9},
        "residuals": {"phi15": {"settled_rate_error_deg_s": 0.1}},
        "rows": [{"element_size_m": 2e-3, "ns_one_thread": 5.0}],
        "peer": "Exudyn",
        "cases": [],
        "files": {"calibration.toml": "0" * 64},
    }


def _store(rng: Rng, folder: Path) -> None:
    path = folder / "store"
    shutil.copytree(_kept_store(), path)
    every = sorted(file for file in path.rglob("*") if file.is_file())
    file = rng.choice(every)
    if file.suffix == ".json" and rng.random() < 0.7:
        file.write_bytes(_changed_json(rng, json.loads(file.read_bytes())))
    elif rng.random() < 0.2:
        file.unlink()
    else:
        file.write_bytes(mutants.of_bytes(rng, file.read_bytes()))
    try:
        found = _opened_store(path)
        for _ in found.pending():
            found.write(_chunk())
        assert not found.pending()
        assert found.failures() and found.digest() and len(found.results()[1]) == _CASES
    except StoreError as fault:
        raise SceneError([Fault(str(path), "store", str(fault), "a whole one")]) from None


_CASES, _KEYS = 6, ["payload.mass", "thrust.peak"]


def _opened_store(path: Path) -> Store:
    return Store(path, _CASES, _KEYS, {"scene": "a", "cases": {"seed": 1}}, {"scene": {}})


@cache
def _kept_store() -> Path:
    path = Path(_KEPT.name) / "store"
    _opened_store(path).write(_chunk())
    return path


def _chunk() -> Chunk:
    """The cases, two of which failed."""
    assert _CASES <= CHUNK
    numbers = np.arange(float(_CASES))
    found = Columns(
        status=np.array([0, 0, 3, 0, 0, 4], dtype=np.int8),
        steps=np.arange(_CASES),
        **{
            name: np.stack([numbers] * 3, axis=1) if name in columns.VECTORS else numbers
            for name in columns.UNITS
        },
    )
    rows = [{"payload.mass": 9.0 + case, "thrust.peak": 6e3} for case in range(_CASES)]
    return Chunk(0, rows, found, ["", "close", "too deep", "", "", "no"])


_KEPT = tempfile.TemporaryDirectory()  # removed when the process ends


KINDS: dict[str, Callable[[Rng, Path], None]] = {
    "compliance": _compliance,
    "run": _run,
    "checkpoint": _checkpoint,
    "stage": _stage,
    "store": _store,
}
