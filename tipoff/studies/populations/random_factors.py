"""The paper's random factors (its Table 3), and the possible readings of "normal axial value,
uniform radial angle".

    signed       x normal about zero, three sigma as printed, at the angle a; a negative x is at the
                 angle a + pi
    half         |x| at the angle a
    components   one such x along y, another along z: the size has a Rayleigh distribution

If every error has its own angle, signed and half are the same distribution, since a + pi is uniform
too; components are larger. If all errors share one angle, thrust and mass eccentricity are on one
line, and their signs decide whether they add or cancel.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.lowfi.ensemble.derived import Derived, Numbers, around_zero, law
from tipoff.scenes.distributions import Distribution
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.populations.reading import INTERFACE_FACTOR, Reading

_INTERFACE = "contact.interface_stiffness"
_SCENE_KEYS = ("initial.", _INTERFACE)  # names of draws that are overrides without a change


class Error(NamedTuple):
    """An error of assembly: the dotted ``key`` above ``axial`` and ``radial``, ``words`` for a
    reader, the three sigma of Table 3 (SI), and the displayed ``unit`` with its size ``scale``
    (SI)."""

    key: str
    words: str
    three_sigma: float
    unit: str
    scale: float


ERRORS = {
    "misalignment": Error(
        "thrust_offset.misalignment",
        "thrust misalignment",
        math.radians(0.4),
        "deg",
        math.radians(1.0),
    ),
    "thrust_eccentricity": Error(
        "thrust_offset.eccentricity", "thrust eccentricity", 0.6e-3, "mm", 1e-3
    ),
    "mass_eccentricity": Error("mass_offset.eccentricity", "mass eccentricity", 0.4e-3, "mm", 1e-3),
}


# The readings that are compared, the default first.
READINGS = (
    Reading(),
    Reading("half"),
    Reading("components"),
    Reading(angles="shared"),
    Reading("half", "shared"),
    Reading(rule="clip"),
    Reading(rule="none"),
    Reading(initial=True),
    Reading(interface=True),
)


def source(scene: Scene, reading: Reading, cases: int, seed: int) -> Derived:
    """Cases of ``scene`` with a ``reading``. Raises SceneError for options that contradict each
    other, every fault listed."""
    faults = []
    if reading.values == "components" and reading.angles == "shared":
        faults.append(
            Fault(
                "--angles",
                "value",
                "shared",
                "independent, since two components determine the angle",
            )
        )
    if reading.initial and not (scene.contact is not None and scene.contact.narrowest() > 0.0):
        faults.append(Fault("--initial", "contact.clearance", "nothing", "a clearance"))
    if reading.interface and scene.contact is None:
        faults.append(Fault("--interface", "contact", "nothing", "contact"))
    if faults:
        raise SceneError(faults)
    return Derived(
        Uncertainty(cases, seed, "random", _laws(scene, reading)),
        lambda drawn: _overrides(reading, drawn),
    )


def _laws(scene: Scene, reading: Reading) -> dict[str, Distribution]:
    """Distributions of the draws by name."""
    whole_turn = law("uniform", low=0.0, high=2.0 * math.pi)
    found: dict[str, Distribution] = {}
    for name, error in ERRORS.items():
        normal = around_zero(error.three_sigma, reading.rule)
        found |= (
            {f"{name} y": normal, f"{name} z": normal}
            if reading.values == "components"
            else {name: normal}
        )
        if reading.values != "components" and reading.angles == "independent":
            found[f"{name} angle"] = whole_turn
    if reading.angles == "shared":
        found["angle"] = whole_turn
    if reading.initial:
        assert scene.contact is not None  # otherwise ``source`` has refused the reading
        found |= {
            f"initial.position.{axis}": law("uniform", low=-gap, high=gap)
            for axis, gap in zip("yz", scene.contact.gaps()[1:])
        }
    if reading.interface:
        assert scene.contact is not None
        nominal = scene.contact.interface_stiffness
        low, high = nominal / INTERFACE_FACTOR, nominal * INTERFACE_FACTOR
        found[_INTERFACE] = law("log-uniform", low=low, high=high)
    return found


def _overrides(reading: Reading, drawn: Numbers) -> Numbers:
    """Overrides of the scene from the draws."""
    found = {key: values for key, values in drawn.items() if key.startswith(_SCENE_KEYS)}
    for name, error in ERRORS.items():
        if reading.values == "components":
            size, angle = _polar(drawn[f"{name} y"], drawn[f"{name} z"])
        else:
            size, angle = (
                drawn[name],
                drawn["angle" if reading.angles == "shared" else f"{name} angle"],
            )
            size, angle = pointing(np.abs(size) if reading.values == "half" else size, angle)
        found |= {f"{error.key}.axial": size, f"{error.key}.radial": angle}
    return found


def pointing(value: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Size and angle of signed values (n,) at ``angle`` (n,), rad: a scene has no negative offset."""
    return np.abs(value), np.where(value < 0.0, angle + math.pi, angle)


def _polar(y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    # One number at a time, because NumPy's vector code may round the end of an array differently.
    pairs = list(zip(y.tolist(), z.tolist()))
    return np.array([math.hypot(*pair) for pair in pairs]), np.array(
        [math.atan2(b, a) for a, b in pairs]
    )
