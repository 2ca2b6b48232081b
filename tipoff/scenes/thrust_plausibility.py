"""Warnings about a thrust that is probably in a wrong unit, or whose record is not zero at its
ends.

    v = J g,     a = F g,     g = 1/m (+ 1/M of a platform that takes the reaction)

v is the speed from the whole impulse J, a the acceleration at the peak F. Bounds: satellites leave
their dispensers at 0.3 to 3 m/s, and rockets their rails at 15 to 60 m/s with 5 to 100 g. After the
exit a rocket gains much more speed, so its v is not judged. A load cell reads zero before ignition
and after burn-out; any other reading adds to the impulse.
"""

import numpy as np

from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes import launch
from tipoff.scenes.effects.load_cell import Level
from tipoff.scenes.effects.measured import FIT_IMPULSE, MeasuredCurve
from tipoff.scenes.rounding import at_most, below

_GRAVITY = 9.80665
FASTEST, SLOWEST = 100.0, 0.05  # m/s
HARDEST, HARDEST_ROCKET = 1000.0 * _GRAVITY, 100.0 * _GRAVITY  # m/s2
_USUAL = (0.1, 60.0)  # m/s: speed with a unit that explains an implausible one
_UNITS = (
    (1e-3 * _GRAVITY, "gf"),
    (1e-3, "mN"),
    (4.4482216152605, "lbf"),
    (_GRAVITY, "kgf"),
    (1e3, "kN"),
)
_SAID = 0.005  # of the impulse: offset that is reported
_CUT = 0.01  # of the peak: largest value at the ends of a record
_RESIDUAL = 0.1  # of a fit that is used


def warnings(scene) -> list[str]:
    """A message for each implausible speed or acceleration, and for each fault of a measured record."""
    found = _of_size(scene)
    if scene.thrust.kind == "measured":
        found += _of_record(scene.thrust) + _of_fit(scene.thrust)
    return found


def _of_size(scene) -> list[str]:
    """A thrust that is too strong or too weak for its mass and rail."""
    keys = "thrust, payload.mass"
    along = launch.of_scene(scene)
    record, speed = ends.over_time(along), ends.speed_change(along)
    limit = max(thrust_law.last(record), 1e-9)
    strongest = thrust_law.peak(record, limit) / scene.payload.mass
    leaves = ends.exit_speed(along)
    if speed < 0.0:
        return [
            f"{keys}: the impulse is {thrust_law.impulse(record, limit):.4g} N s, away from the open "
            "end; plausible above 0: its sign is probably wrong"
        ]
    said = (
        f"{speed:.4g} m/s by the thrust"
        + ("" if leaves is None else f", {leaves:.4g} m/s at the exit")
        + f" after {1e3 * along.way:.4g} mm, {strongest / _GRAVITY:.4g} g at the peak of "
        f"{strongest * scene.payload.mass:.4g} N on {scene.payload.mass:.4g} kg"
    )
    rocket = scene.thrust.reaction == "exhaust" and at_most(strongest, HARDEST_ROCKET)
    judged = (leaves or 0.0) if rocket else speed
    if below(FASTEST, judged) or below(HARDEST, strongest):
        allowed = f"plausible up to {FASTEST:g} m/s and {HARDEST / _GRAVITY:g} g"
        return [f"{keys}: {said}; {allowed}{_meant(scene, speed, strongest, weaker=True)}"]
    if speed > 0.0 and below(speed, SLOWEST) and not ends.is_driven_otherwise(along):
        allowed = f"plausible from {SLOWEST:g} m/s on"
        return [f"{keys}: {said}; {allowed}{_meant(scene, speed, strongest, weaker=False)}"]
    return []


def _meant(scene, speed: float, strongest: float, weaker: bool) -> str:
    """Units of the forces that the user may have meant, as the end of a message; those of a motor
    are known."""
    thrust = scene.thrust
    is_rocket = weaker and thrust.reaction == "platform" and strongest <= HARDEST_ROCKET
    rocket = 'a rocket, which burns on after the exit, has thrust.reaction = "exhaust"'
    if (
        is_rocket
        and thrust.kind == "measured"
        and (thrust.file or "").lower().endswith((".eng", ".rse"))
    ):
        return f"; {rocket}"
    units = [
        (factor, name)
        for factor, name in _UNITS
        if (factor < 1.0) == weaker and _USUAL[0] <= factor * speed <= _USUAL[1]
    ]
    if not units:
        return "; is the mass, or the unit of the force or of the time, wrong?"
    words = " or ".join(f"{factor * speed:.4g} m/s if it is in {name}" for factor, name in units)
    found = f"; likely cause: the force is in another unit than N ({words})"
    if weaker and thrust.kind == "measured":
        found += ", or times are in ms"
    return f"{found}; {rocket}" if is_rocket else found


def _of_record(table) -> list[str]:
    curve = table.curve()
    peak = float(np.abs(curve.force).max())
    if peak == 0.0:
        return []
    before, after = table.levels()
    key = "thrust.points" if table.file is None else "thrust.file"
    ends = _of_ends(curve, peak, before, after)
    return _of_offset(table, before, after) + [f"{key}, {words}" for words in ends]


def _of_offset(table, before: Level | None, after: Level | None) -> list[str]:
    """Readings before ignition and after burn-out that are not zero, and their impulse."""
    seen = [item for item in (before, after) if item is not None and item.is_seen]
    if not seen:
        return []
    first, last = (item.value if item is not None else seen[0].value for item in (before, after))
    curve = table.curve()
    lasting = float(curve.time[-1] - curve.time[0])
    added, whole = 0.5 * (first + last) * lasting, table.requested()
    other = whole - added
    larger = max(abs(first), abs(last)) * lasting
    if larger <= _SAID * abs(other):
        return []
    share = f", {100.0 * added / other:+.3g} % of the {other:.4g} N s without it" if other else ""
    words = ", ".join(
        f"{item.value:.4g} N {where}"
        for item, where in ((before, "before ignition"), (after, "after burn-out"))
        if item is not None
    )
    given = table.baseline or (0.0, 0.0)
    pair = ", ".join(f'"{old + new:.5g} N"' for old, new in zip(given, (first, last)))
    return [
        f"thrust.baseline: the force does not return to zero: {words}; over the {lasting:.4g} s of the "
        f"record this adds {added:.4g} N s{share}; plausible below {100.0 * _SAID:g} %. "
        f"thrust.baseline = [{pair}] subtracts it"
        + ("" if table.remove_offset or table.baseline else ", or thrust.remove_offset = true")
    ]


def _of_ends(
    curve: MeasuredCurve, peak: float, before: Level | None, after: Level | None
) -> list[str]:
    """A record that begins or ends with thrust."""
    found = []
    first, last = float(curve.force[0]), float(curve.force[-1])
    if before is None and curve.time[0] > 0.0 and abs(first) > _CUT * peak:
        added = 0.5 * first * float(curve.time[0])
        found.append(
            f"first point: {first:.4g} N at {curve.time[0]:.4g} s, {100.0 * first / peak:.3g} "
            "% of the peak; plausible: 0 N at ignition. The thrust is zero before; a straight line "
            f"from 0 N at 0 s adds {added:.4g} N s"
        )
    if after is None and abs(last) > _CUT * peak:
        found.append(
            f"last point: {last:.4g} N at {curve.time[-1]:.4g} s, {100.0 * last / peak:.3g} "
            "% of the peak; plausible: 0 N after burn-out. The thrust is zero from there on; if it is "
            "meant so, a second row with this time and 0 N says so"
        )
    return found


def _of_fit(table) -> list[str]:
    """A used fit with a large residual, or with an error of impulse above the default limit."""
    fit = table.fit() if table.use == "fit" else None
    if fit is None:
        return []
    error, residual = fit.impulse_error, fit.relative_residual
    if at_most(abs(error), FIT_IMPULSE) and at_most(residual, _RESIDUAL):
        return []
    return [
        f'thrust.use: "fit", whose residual is {100.0 * residual:.3g} % and whose impulse differs by '
        f"{100.0 * error:+.3g} % from the {fit.curve_impulse:.5g} N s of the curve; plausible up to "
        f"{100.0 * _RESIDUAL:g} % and {100.0 * FIT_IMPULSE:g} %"
    ]
