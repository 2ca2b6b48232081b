"""Stiffness of machined joints: what was measured, beside the laws of docs/interface_stiffness.md
and the catalogue's interface stiffness.

Measured joints approach each other by d = C p^m, hence k = dp/dd = p^(1 - m) / (C m).
"""

import math

from tipoff import scenes

KGF_PER_CM2 = 98066.5  # Pa
HARDNESS = 1.5e9  # Pa, as in docs/interface_stiffness.md


def measured(pressure: float, c: float, m: float) -> float:
    """Stiffness (N/m3) at ``pressure`` (Pa) of a joint with d (um) = c p^m, p in kgf/cm2."""
    p = pressure / KGF_PER_CM2
    return KGF_PER_CM2 / (1e-6 * c * m * p ** (m - 1.0))


def yovanovich(pressure: float, roughness: float) -> float:
    """Stiffness (N/m3) p / (0.097 Y), Y = 1.53 s (p/H)^-0.097, of combined rms ``roughness`` s
    (m)."""
    return pressure / (0.097 * 1.53 * roughness * (pressure / HARDNESS) ** -0.097)


def greenwood_williamson(pressure: float, roughness: float) -> float:
    """Stiffness (N/m3) p / s of exponential summit heights."""
    return pressure / roughness


def combined(centre_line_average: float) -> float:
    """Combined rms roughness (m) of two like surfaces: sqrt(2) times 1.25 times the average, for
    normal heights."""
    return math.sqrt(2.0) * math.sqrt(math.pi / 2.0) * centre_line_average


def ours(at: list[float]) -> dict[str, list[float]]:
    """Stiffness (1e12 N/m3) at pressures ``at`` (MPa) of ground surfaces of 1 um, by both laws, and
    that of the reference scene, which does not depend on the pressure."""
    rough = combined(1e-6)
    kept = scenes.load("reference").contact.interface_stiffness
    return {
        "Yovanovich": [yovanovich(1e6 * p, rough) / 1e12 for p in at],
        "Greenwood and Williamson": [greenwood_williamson(1e6 * p, rough) / 1e12 for p in at],
        "reference scene": [kept / 1e12 for _ in at],
    }
