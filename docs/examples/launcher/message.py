"""What goes to the browser: the launcher in millimetres and the samples of one run, as numbers of
32 bits, one row a sample::

    time (ms), place (mm) and rotation vector (rad) of the payload in axes of the platform,
    rates (deg/s, payload axes), velocity (m/s, scene axes), thrust (N), force on each pad (N)
"""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from tipoff import Scene, Trajectory
from tipoff.mechanics.laws import thrust as thrust_law

MOST_ROWS = 400  # more than a chart has pixels, and 30 kB
_MM = 1e3
_STANDS_OUT = 6.0  # mm from the drawn body to the corner of a pad, so that pads can be seen


def made(scene: Scene, run: Trajectory) -> dict:
    """Everything the view draws of one ``run`` of ``scene``."""
    table = rows(scene, run)
    return {
        "launcher": launcher(scene),
        "loads": loads(scene),
        "answer": answer(scene, run),
        "rows": table.tobytes(),
        "width": table.shape[1],
    }


def answer(scene: Scene, run: Trajectory) -> dict:
    """Status, exit time (ms), settled rates (deg/s) and velocity (m/s), angle of the velocity off the
    axis (deg); None for what a run that does not settle lacks."""
    result = run.outcome
    settled = result.rate is not None
    return {
        "name": scene.name,
        "status": run.status,
        "message": run.message,
        "exit_ms": result.exit_time * 1e3 if settled else None,
        "window_ms": result.window_start * 1e3 if settled else None,
        "rate": np.degrees(result.rate).tolist() if settled else None,
        "velocity": list(result.velocity) if settled else None,
        "off_axis": math.degrees(result.direction_error) if settled else None,
    }


def error(run: Trajectory) -> dict:
    """The error of the rates of a ``run``, or the range of a sensitive one, in the words of its summary."""
    assert run.error is not None  # of a run with its sensitivity
    found = run.error.range
    spans = [] if found is None else zip("xyz", found.low_deg_s, found.high_deg_s)
    ends = ", ".join(f"{axis} {low:.3f} to {high:.3f} deg/s" for axis, low, high in spans)
    return {"words": f"{run.error.words}{ends and ': '}{ends}", "is_sensitive": found is not None}


def rows(scene: Scene, run: Trajectory) -> np.ndarray:
    """Samples (n, 14 + pads) of ``run``, at most ``MOST_ROWS`` of them; the columns are those of the
    module's text."""
    count = run.time.size
    kept = np.unique(np.linspace(0, count - 1, min(count, MOST_ROWS)).round().astype(int))
    platform = Rotation.from_quat(run.platform_quaternion[kept], scalar_first=True)
    turned = platform.inv() * Rotation.from_quat(run.quaternion[kept], scalar_first=True)
    centre = platform.inv().apply(run.position[kept] - run.platform_position[kept])
    if scene.platform is not None:
        centre += [getattr(scene.platform.mass_centre, axis) for axis in "xyz"]
    # the drawing hangs on the nominal mass centre, the run on the actual one
    columns = [
        1e3 * run.time[kept, None],
        _MM * (centre - turned.apply(_mass_offset(scene))),
        turned.as_rotvec(),
        np.degrees(run.rate[kept]),
        run.velocity[kept],
        thrust_law.sample(scene.thrust.record(), run.time[kept])[:, None],
        _pad_forces(scene, run)[kept],
    ]
    return np.hstack(columns).astype("<f4")


def _pad_forces(scene: Scene, run: Trajectory) -> np.ndarray:
    """Force (n, pads) N on each pad, the sum over its faces."""
    of_face = [number for number, pad in enumerate(scene.pads) for _ in pad.normals]
    total = np.zeros((run.time.size, len(scene.pads), 3))
    np.add.at(total, (slice(None), of_face), run.pad_force)
    return np.linalg.norm(total, axis=2)


def loads(scene: Scene) -> dict:
    """Line of the thrust and mass centre in payload axes, from the nominal mass centre (mm), and the
    unit direction of the thrust."""
    offset = scene.thrust_offset
    direction = offset.misalignment.direction() if offset else (1.0, 0.0, 0.0)
    line = offset.eccentricity.offset() if offset else (0.0, 0.0, 0.0)
    return {
        "direction": list(direction),
        "line": [_MM * item for item in line],
        "arm": _MM * scene.thrust.arm,
        "mass": [_MM * item for item in _mass_offset(scene)],
    }


def _mass_offset(scene: Scene) -> tuple[float, float, float]:
    return scene.mass_offset.eccentricity.offset() if scene.mass_offset else (0.0, 0.0, 0.0)


def launcher(scene: Scene) -> dict:
    """Boxes of payload and pads, and walls of the rails, in mm and scene axes at ignition. A wall is
    drawn from ``wall`` outwards by the clearance, as far as the view exaggerates it."""
    gaps = scene.contact.gaps() if scene.contact else (0.0, 0.0, 0.0)
    pads = [_pad(pad) for pad in scene.pads]
    corners = np.abs([pad.position for pad in scene.pads]) * _MM
    size = scene.payload.size or 2.0 * corners.max(axis=0) / _MM
    half = [_MM * size[0] / 2] + [
        max(1.0, min(_MM * size[axis] / 2, corners[:, axis].min() - _STANDS_OUT)) for axis in (1, 2)
    ]
    return {
        "body": half,
        "pads": pads,
        "walls": _walls(scene),
        "gaps": [_MM * gap for gap in gaps],
        "rail": [_MM * scene.rail.start, _MM * scene.rail.end],
        "thickness": _MM * (getattr(scene.rail, "thickness", None) or 0.004),
        "mounts": [
            [_MM * (scene.rail.start + span.start), _MM * (scene.rail.start + span.end)]
            for span in getattr(scene.rail, "mounts", ())
        ],
    }


def _pad(pad) -> dict:
    """Centre and half size (mm) of the block of a pad, whose corner is its place."""
    corner = _MM * np.array(pad.position)
    depth = _MM * (pad.inset + pad.width / 2) / 2
    half = np.array([_MM * pad.length / 2, depth, depth])
    centre = corner - np.sign(corner) * np.array([0.0, depth, depth])
    return {"centre": centre.tolist(), "half": half.tolist()}


def _walls(scene: Scene) -> list[dict]:
    """Each wall once: its ``axis`` (1 or 2), the ``sign`` of the pads' normals, the place of the
    pads' faces along that axis and the two ends across it (mm)."""
    leg = _MM * (getattr(scene.rail, "leg", None) or 0.024)
    found = {}
    for pad in scene.pads:
        for normal in pad.normals:
            axis, sign = "xyz".index(normal[1]), 1 if normal[0] == "+" else -1
            face, corner = _MM * pad.position[axis], _MM * pad.position[3 - axis]
            across = sorted([corner, corner - math.copysign(leg, corner)])
            wall = {"axis": axis, "sign": sign, "face": face, "across": across}
            found[axis, sign, round(face, 3), round(corner, 3)] = wall
    return list(found.values())
