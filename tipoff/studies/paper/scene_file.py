"""A set of inputs as a scene file that extends another, each number with its provenance."""

import numpy as np

from tipoff.scenes import provenance
from tipoff.scenes.scene import Scene
from tipoff.studies import published
from tipoff.studies.paper import inputs

_UNITS = {
    "payload.mass": ("kg", 1.0),
    "payload.inertia": ("kg*m**2", 1.0),
    "rail.start": ("mm", 1e3),
    "rail.end": ("mm", 1e3),
    "contact.clearance": ("mm", 1e3),
    "contact.damping": ("N*s/mm", 1e-3),
    "contact.damping_depth": ("mm", 1e3),
    "thrust.peak": ("N", 1.0),
    "thrust.width": ("ms", 1e3),
    "thrust.centre": ("ms", 1e3),
    "thrust.arm": ("mm", 1e3),
    "initial.position": ("um", 1e6),
    "duration": ("ms", 1e3),
}
_PRINTED = ("contact.stiffness", "contact.damping", "contact.damping_depth")
_DIGITS = 9


def scene(base: Scene, found: dict[str, float], rates: np.ndarray) -> str:
    """TOML of a scene like ``base`` with inputs ``found`` (``inputs.values``), whose settled
    ``rates`` (5,3) deg/s its description has."""
    changed = inputs.overrides(base, found)
    error = np.abs(
        rates[[condition - 1 for condition in published.SENSITIVE]]
        - published.sensitivity().baseline
    ).max()
    lines = [
        f'extends = "{base.name}"',
        'name = "paper_like"',
        "description = \"Inputs inferred so that the settled rates of the paper's Table 2 come "
        "out, "
        f'all nine within {error:.2g} deg/s."',
        f"duration = {_quantity('duration', changed['duration'])}",
    ]
    lines += _table("payload", {"mass": changed["payload.mass"]})
    lines += _table("payload.inertia", _under(changed, "payload.inertia"))
    lines += _table("rail", {end: changed[f"rail.{end}"] for end in ("start", "end")})
    mounts = ", ".join(
        f'{{ start = "{1e3 * item["start"]:.6g} mm", end = "{1e3 * item["end"]:.6g} mm" }}'
        for item in changed["rail.mounts"]
    )
    lines += [f"mounts = [{mounts}]"]
    lines += _table("thrust", _under(changed, "thrust"))
    lines += [
        "",
        "[contact]",
        f"exponent = {changed['contact.exponent']:.{_DIGITS}g}",
        f'stiffness = "{inputs.STIFFNESS:g} N/mm**{changed["contact.exponent"]:.{_DIGITS}g}"',
    ]
    lines += [
        f"{name} = {_quantity(f'contact.{name}', changed[f'contact.{name}'])}"
        for name in ("clearance", "damping", "damping_depth")
    ]
    lines += [
        "",
        "[friction]",
        *(f"{name} = {changed[f'friction.{name}']:.{_DIGITS}g}" for name in ("static", "dynamic")),
    ]
    lines += _table("initial.position", _under(changed, "initial.position"))
    lines += [
        "",
        "[agreement]",
        'fitted = ["phi0", "phi15", "phi35", "phi60", "phi90"]',
        "held_out = []",
        'floor = ["phi15"]',
        'refined = ["phi35"]',
        "",
        "[provenance]",
    ]
    inferred = sorted(
        {_home(key) for key in changed if key not in _PRINTED and not key.startswith("pads")}
        | {"pads"}
    )
    lines += [f'"{key}" = "inferred"' for key in inferred]
    lines += [
        f'"{key}" = {_text(said)}'
        for key in _PRINTED
        if (said := provenance.of(base.provenance, key)) is not None
    ]
    for number, pad in enumerate(base.pads):
        place = ", ".join(
            f'"{1e3 * changed[f"pads.{number}.position.{axis}"]:.{_DIGITS}g} mm"'
            for axis in range(3)
        )
        lines += [
            "",
            "[[pads]]",
            f"position = [{place}]",
            f"normals = [{', '.join(map(_text, pad.normals))}]",
            *(
                f'{name} = "{1e3 * getattr(pad, name):.{_DIGITS}g} mm"'
                for name in ("length", "width", "inset", "relief")
            ),
        ]
    return "\n".join(lines) + "\n"


def _under(changed: dict, table: str) -> dict[str, float]:
    return {
        key.removeprefix(f"{table}."): value
        for key, value in changed.items()
        if key.startswith(f"{table}.")
    }


def _table(name: str, values: dict[str, float]) -> list[str]:
    return [
        "",
        f"[{name}]",
        *(f"{key} = {_quantity(f'{name}.{key}', value)}" for key, value in values.items()),
    ]


def _quantity(key: str, value: float) -> str:
    unit, factor = _UNITS.get(key) or _UNITS[key.rpartition(".")[0]]
    return f'"{factor * value:.{_DIGITS}g} {unit}"'


def _home(key: str) -> str:
    """The key under which a provenance stands: an inertia or a position as a whole."""
    return (
        key.rpartition(".")[0] if key.startswith(("payload.inertia", "initial.position")) else key
    )


def _text(word: str) -> str:
    return f'"{word}"'
