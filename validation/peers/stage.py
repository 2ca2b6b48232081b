"""Comparisons with other codes: runs every case in both codes, and keeps the results.

The results of a peer are one JSON file, ``<peer>.json``; those in the folder ``kept`` are part of the
project. Tests compare today's numbers with them where a peer is not installed.
"""

from collections.abc import Iterable
from pathlib import Path

from tipoff.faults import Fault, SceneError
from tipoff.files import read_json, write_json
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from tipoff.workspace.study import StudyError
from validation.peers import (
    calculix,
    calculix_event,
    calculix_impact,
    calculix_modes,
    calculix_rail,
    exudyn_model,
    mujoco_model,
    quadratic,
    springs_cases,
)
from validation.peers.case import (
    OURS,
    Case,
    Peer,
    PeerMissing,
    Unfinished,
    require_finished,
    timed,
)

KEPT = Path(__file__).parent / "kept"
PEERS = (
    Peer(
        "CalculiX",
        "finite elements, implicit",
        calculix.version,
        lambda: tuple(
            case
            for part in (calculix_rail, calculix_modes, calculix_impact, calculix_event)
            for case in part.cases()
        ),
    ),
    Peer("scikit-fem", "quadratic elements, leapfrog in NumPy", quadratic.version, quadratic.cases),
    Peer("Exudyn", "rigid and flexible bodies", exudyn_model.version, springs_cases.exudyn_cases),
    Peer("MuJoCo", "rigid bodies", mujoco_model.version, springs_cases.mujoco_cases),
)


def run(out: Path, names: Iterable[str] = ()) -> dict:
    """Solve the cases of all peers, or of the named ones; writes ``out``/peers/<peer>.json. A peer
    that is not installed is a ``missing`` row, and its old file stays. Raises SceneError for an
    unknown name of a peer, and StudyError for a run that did not do what was asked."""
    wanted, folder, rows = {name.lower() for name in names}, Path(out) / "peers", []
    known = [peer.name for peer in PEERS]
    if unknown := sorted(wanted - {name.lower() for name in known}):
        expected = f"one of {', '.join(known)}"
        raise SceneError([Fault("PEER", "name", repr(name), expected) for name in unknown])
    for peer in PEERS:
        if not wanted or peer.name.lower() in wanted:
            try:
                found = _solved(peer)
            except PeerMissing as missing:
                rows.append({"peer": peer.name, "missing": str(missing)})
                say(f"  {peer.name}: missing: {missing}")
                continue
            rows.append(write_json(folder / _file(peer), found))
    return {"peers": rows}


def stored(folder: Path) -> list[dict]:
    """The results in a folder, in the order of the peers; a peer without a result is a missing row.
    Raises DamageError."""
    return [
        read_json(folder / _file(peer))
        if (folder / _file(peer)).is_file()
        else {"peer": peer.name, "missing": "not run here"}
        for peer in PEERS
    ]


def _file(peer: Peer) -> str:
    return f"{peer.name.lower()}.json"


def _solved(peer: Peer) -> dict:
    version = peer.version()
    return {
        "peer": peer.name,
        "what": peer.what,
        "version": version,
        "hardware": machine.describe(),
        "state": machine.state(),
        "cases": [_case(case) for case in peer.cases()],
    }


def _case(case: Case) -> dict:
    say(f"  {case.title}")
    try:
        rows = [row for setting in case.settings for row in _rows(case, setting)]
        work = [point._asdict() for point in case.work()] if case.work else []
    except Unfinished as fault:
        raise StudyError(f"{case.title}: {fault}") from fault
    return {
        "name": case.name,
        "title": case.title,
        "inputs": dict(case.inputs()),
        "matched": case.matched,
        "unmatched": case.unmatched,
        "rows": rows,
        "error_of": case.error_of,
        "work": work,
    }


def _rows(case: Case, setting: str) -> list[dict]:
    ours, ours_cpu = timed(lambda: case.ours(setting))
    theirs, theirs_cpu = timed(lambda: case.theirs(setting))
    quantities = [quantity for quantity in case.units if quantity in ours]
    lacking = [quantity for quantity in quantities if quantity not in theirs]
    if lacking or not quantities:
        raise Unfinished(f"no {', '.join(lacking or case.units)}")
    require_finished(OURS, 0.0, 0.0, [ours[quantity] for quantity in quantities])
    require_finished("the other code", 0.0, 0.0, [theirs[quantity] for quantity in quantities])
    if not (ours_cpu > 0.0 and theirs_cpu > 0.0):
        raise Unfinished(f"times of {ours_cpu:g} s and {theirs_cpu:g} s")
    return [
        {
            "setting": setting,
            "quantity": quantity,
            "unit": case.units[quantity],
            "ours": float(ours[quantity]),
            "theirs": float(theirs[quantity]),
            "within": case.within(setting, quantity),
            "ours_cpu_s": ours_cpu,
            "theirs_cpu_s": theirs_cpu,
        }
        for quantity in quantities
    ]


def differences(rows: list[dict]) -> list[float]:
    """Difference of each row, relative to the largest value of its quantity."""
    largest: dict[str, float] = {}
    for row in rows:
        name = row["quantity"]
        largest[name] = max(largest.get(name, 0.0), abs(row["theirs"]))
    return [(row["ours"] - row["theirs"]) / largest[row["quantity"]] for row in rows]
