"""Closed forms of elastodynamics and of the central difference scheme. SI units, angles in
radians."""

import math

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq


def bar_speed(youngs_modulus: float, density: float) -> float:
    """Speed (m/s) of a stress wave in a slender bar, sqrt(E / rho). Graff, Wave Motion in Elastic
    Solids, 1975, ch. 2."""
    return math.sqrt(youngs_modulus / density)


def confined_speed(youngs_modulus: float, poisson_ratio: float, density: float) -> float:
    """Speed (m/s) of a pressure wave with no lateral strain, sqrt((lambda + 2 G) / rho). Graff
    1975, ch. 5."""
    factor = (1.0 - poisson_ratio) / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    return math.sqrt(youngs_modulus * factor / density)


def pushed_bar(
    window: int, force: float, area: float, youngs_modulus: float, density: float
) -> float:
    """Speed (m/s) of the pushed end of a free bar in window `window` (from 1) of 2 L / c, (2 window
    - 1) F / (rho c A): each return of the wave adds twice the first step. Graff 1975, ch. 2;
    Goldsmith, Impact, 1960, ch. 3.
    """
    return (2 * window - 1) * force / (density * bar_speed(youngs_modulus, density) * area)


def largest_shortening(force: float, length: float, area: float, youngs_modulus: float) -> float:
    """Largest shortening (m) of a free bar pushed at one end, F L / E A at t = L / c. It is a
    triangle wave, so its mean is half of that, which is also the shortening under F balanced by the
    bar's own acceleration. Graff 1975, ch. 2."""
    return force * length / (youngs_modulus * area)


def rod_impact(
    length: float, area: float, speed: float, youngs_modulus: float, density: float
) -> dict[str, float]:
    """Duration (s) 2 L / c, stress (Pa) rho c v / 2, force (N) and impulse (N s) m v of a rod
    striking an equal one at rest; a rod that strikes a rigid wall at v is one that strikes an equal
    rod at 2 v. Goldsmith, Impact, 1960, section 3.2.
    """
    wave = bar_speed(youngs_modulus, density)
    stress = 0.5 * density * wave * speed
    return {
        "duration": 2.0 * length / wave,
        "stress": stress,
        "force": stress * area,
        "impulse": density * area * length * speed,
    }


def moving_force_deflection(ratio, way, modes=25):
    """Midspan deflection, over the static one P L^3 / 48 E I, of a simply supported beam when a
    force moving at `ratio` times the critical speed (pi / L) sqrt(E I / rho A) has done the share
    `way` of the span:

    (96 / pi^4) sum over odd k of sin(k pi / 2) / (k^4 (1 - (r/k)^2)) (sin k pi s - (r/k) sin(k^2 pi
    s / r)). Fryba, Vibration of Solids and Structures under Moving Loads, 1972, section 1.1.
    """
    total = np.zeros_like(way)
    for k in range(1, modes + 1, 2):
        slowness = ratio / k
        wave = np.sin(k * math.pi * way) - slowness * np.sin(k * k * math.pi * way / ratio)
        total += math.sin(0.5 * k * math.pi) * wave / (k**4 * (1.0 - slowness**2))
    return 96.0 / math.pi**4 * total


def fixed_free_wavenumber(mode: int, length: float) -> float:
    """Wave number (rad/m) of a bar fixed at one end, (2 mode - 1) pi / 2 L, modes from 1. Graff
    1975, ch. 2."""
    return (2 * mode - 1) * math.pi / (2.0 * length)


def discrete_frequency(wavenumber: float, spacing: float, speed: float, step: float) -> float:
    """Frequency (Hz) of 2-node elements with lumped mass under central differences.

    w_d = (2 c / h) sin(k h / 2), w = (2 / dt) asin(w_d dt / 2). Belytschko and Hughes,
    Computational Methods for Transient Analysis, 1983, ch. 1.
    """
    semidiscrete = 2.0 * speed / spacing * math.sin(0.5 * wavenumber * spacing)
    return math.asin(0.5 * semidiscrete * step) / (math.pi * step)


def modal_decay(ratio: float, cycles: float) -> float:
    """Amplitude left of a mode with damping `ratio` after so many damped cycles, exp(-2 pi z n /
    sqrt(1 - z^2)). Clough and Penzien, Dynamics of Structures, section 2-6.
    """
    return math.exp(-2.0 * math.pi * ratio * cycles / math.sqrt(1.0 - ratio**2))


def leapfrog_growth(ratio: float) -> float:
    """Growth per step of the highest mode at `ratio` >= 1 times the critical step: the larger root
    of g^2 - 2 (2 ratio^2 - 1) g + 1 = 0 in magnitude. Hughes, The Finite Element Method, 1987,
    section 9.1.
    """
    half_trace = 2.0 * ratio**2 - 1.0
    return half_trace + math.sqrt(half_trace**2 - 1.0)


def timoshenko_cantilever(
    count, length, width, height, youngs_modulus, poisson_ratio, density, shear_factor=5.0 / 6.0
):
    """First `count` bending frequencies (Hz) of a rectangular cantilever, bending across `height`;
    see `_timoshenko`."""
    return _timoshenko(
        slice(2, 4),
        count,
        length,
        width,
        height,
        youngs_modulus,
        poisson_ratio,
        density,
        shear_factor,
    )


def timoshenko_free(
    count, length, width, height, youngs_modulus, poisson_ratio, density, shear_factor=5.0 / 6.0
):
    """First `count` flexible bending frequencies (Hz) of the same beam with both ends free; see
    `_timoshenko`."""
    return _timoshenko(
        slice(0, 2),
        count,
        length,
        width,
        height,
        youngs_modulus,
        poisson_ratio,
        density,
        shear_factor,
    )


def _timoshenko(
    start, count, length, width, height, youngs_modulus, poisson_ratio, density, shear_factor
):
    """With y = (w, psi, M, V) the beam obeys y' = A(w^2) y. The first end leaves the components
    `start` open (M and V at a clamp, w and psi where it is free), the other end wants M = V = 0, so
    frequencies are the roots of the determinant of that 2x2 block of exp(A L). Timoshenko, Phil.
    Mag. 41 (1921) 744.
    """
    area, inertia = width * height, width * height**3 / 12.0
    bending = youngs_modulus * inertia
    shear = shear_factor * area * youngs_modulus / (2.0 * (1.0 + poisson_ratio))

    def determinant(frequency):
        square = (2.0 * math.pi * frequency) ** 2
        # Moments and forces in units of EI/L and EI/L^2, lengths in L: otherwise exp(A L) loses all
        # digits.
        slope = np.array(
            [
                [0.0, 1.0, 0.0, bending / (shear * length**2)],
                [0.0, 0.0, 1.0, 0.0],
                [0.0, -density * inertia * square * length**2 / bending, 0.0, -1.0],
                [-density * area * square * length**4 / bending, 0.0, 0.0, 0.0],
            ]
        )
        return np.linalg.det(expm(slope)[2:, start])

    roots, lower, increment = [], 1.0, 5.0
    while len(roots) < count:
        if determinant(lower) * determinant(lower + increment) < 0.0:
            roots.append(brentq(determinant, lower, lower + increment, xtol=1e-9))
        lower += increment
    return np.array(roots)


def cantilever_deflection(
    force, length, width, height, youngs_modulus, poisson_ratio, shear_factor=5.0 / 6.0
):
    """Bending and shear part (m) of the tip deflection across `height` under a tip force (N): P L^3
    / 3 E I + P L / (kappa G A). Timoshenko, Strength of Materials I, arts. 21 and 39.
    """
    bending = force * length**3 / (3.0 * youngs_modulus * width * height**3 / 12.0)
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poisson_ratio))
    return bending, force * length / (shear_factor * shear_modulus * width * height)


def spinning_bar_stretch(
    length: float, rate: float, youngs_modulus: float, density: float
) -> float:
    """Stretch (m) of a bar that turns about its root at `rate` rad/s, rho w^2 L^3 / 3 E. Timoshenko
    and Goodier, art. 32."""
    return density * rate**2 * length**3 / (3.0 * youngs_modulus)


def twist_of_bar(couple, length, width, thickness, youngs_modulus, poisson_ratio):
    """Turn (rad) of a rectangular bar, `width` >= `thickness`, under a couple (N m) at its end: M L
    / G J with Saint-Venant's J = w t^3 (1/3 - 64 t / (pi^5 w) sum over odd k of tanh(k pi w / 2 t)
    / k^5). Timoshenko and Goodier, art. 109.
    """
    series = sum(math.tanh(0.5 * k * math.pi * width / thickness) / k**5 for k in range(1, 30, 2))
    constant = width * thickness**3 * (1.0 / 3.0 - 64.0 * thickness / (math.pi**5 * width) * series)
    return couple * length * 2.0 * (1.0 + poisson_ratio) / (youngs_modulus * constant)


def pressed_cylinder_displacement(radius, inner, outer, pressure, youngs_modulus, poisson_ratio):
    """Radial displacement (m) at `radius` of a thick cylinder under inner pressure (Pa) in plane
    strain: (1 + nu) p a^2 ((1 - 2 nu) r + b^2 / r) / E (b^2 - a^2). Lame; Timoshenko and Goodier,
    art. 28.
    """
    scale = (1.0 + poisson_ratio) * pressure * inner**2 / (youngs_modulus * (outer**2 - inner**2))
    return scale * ((1.0 - 2.0 * poisson_ratio) * radius + outer**2 / radius)


def pressed_cylinder_stress(points, inner, outer, pressure, poisson_ratio):
    """Stress (...,6) in Pa, ordered xx yy zz xy yz zx, at points (...,3) of the same cylinder about
    the z axis: radial and hoop stress p a^2 (1 -+ b^2 / r^2) / (b^2 - a^2), axial stress nu times
    their sum.
    """
    radius = np.hypot(points[..., 0], points[..., 1])
    cosine, sine = points[..., 0] / radius, points[..., 1] / radius
    scale = pressure * inner**2 / (outer**2 - inner**2)
    radial, hoop = scale * (1.0 - (outer / radius) ** 2), scale * (1.0 + (outer / radius) ** 2)
    zero = np.zeros_like(radius)
    return np.stack(
        [
            radial * cosine**2 + hoop * sine**2,
            radial * sine**2 + hoop * cosine**2,
            poisson_ratio * (radial + hoop),
            (radial - hoop) * sine * cosine,
            zero,
            zero,
        ],
        axis=-1,
    )
