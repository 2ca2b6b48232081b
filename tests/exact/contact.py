"""Closed forms of one body against one compliant wall. SI units; penetration p, closing speed v at
first touch."""

import math

from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def impact_force(k: float, e: float, c: float, d: float, p: float, closing: float) -> float:
    """Normal force (N) of IMPACT with no pull: max(0, k p^e + c s(p/d) p'), s = x^2 (3 - 2x) (MSC
    ADAMS/Solver, IMPACT function)."""
    x = min(p / d, 1.0)
    return max(0.0, k * p**e + c * x * x * (3.0 - 2.0 * x) * closing)


def impact_collision(
    mass: float, v: float, k: float, e: float, c: float, d: float
) -> dict[str, float]:
    """Restitution, deepest penetration (m), largest force (N) and duration (s) from m p'' = -F(p,
    p'), integrated by DOP853 at 1e-13."""

    def slope(_, y):
        p = max(y[0], 0.0)
        return [y[1], -impact_force(k, e, c, d, p, y[1]) / mass]

    def apart(t, y):
        return y[0] if t > 0.0 else 1.0

    apart.terminal, apart.direction = True, -1.0
    period = math.pi * v / (k * (mass * v * v / k) ** (e / (e + 1.0)) / mass)
    found = solve_ivp(
        slope,
        (0.0, 20.0 * period),
        [0.0, v],
        method="DOP853",
        rtol=1e-13,
        atol=1e-18,
        events=apart,
        dense_output=True,
        max_step=period / 500.0,
    )
    end = found.t_events[0][0]
    times = [end * i / 20000 for i in range(20001)]
    states = found.sol(times)
    force = max(impact_force(k, e, c, d, max(p, 0.0), q) for p, q in states.T)
    return {
        "restitution": -found.y_events[0][0][1] / v,
        "penetration": states[0].max(),
        "force": force,
        "duration": end,
    }


def power_law_collision(mass: float, v: float, k: float, n: float) -> dict[str, float]:
    """Penetration (m), force (N), duration (s) on F = k p^n: p = ((n+1) m v^2 / 2k)^(1/(n+1)), T =
    (2p/v) sqrt(pi) Gamma(1 + 1/(n+1)) / Gamma(1/2 + 1/(n+1)) (Goldsmith, Impact, 1960, section
    4.2)."""
    p = ((n + 1.0) * mass * v * v / (2.0 * k)) ** (1.0 / (n + 1.0))
    a = 1.0 / (n + 1.0)
    duration = 2.0 * p / v * math.sqrt(math.pi) * math.gamma(1.0 + a) / math.gamma(0.5 + a)
    return {"penetration": p, "force": k * p**n, "duration": duration}


def hertz_stiffness(radius: float, ball: tuple[float, float], plane: tuple[float, float]) -> float:
    """Stiffness k (N/m^1.5) of F = k p^1.5 between a ball and a half-space, each (E in Pa, nu): 4/3
    E* sqrt R, 1/E* = sum of (1 - nu^2) / E (Johnson, Contact Mechanics, 1985, section 4.2)."""
    return (
        4.0
        / 3.0
        * math.sqrt(radius)
        / sum((1.0 - nu**2) / modulus for modulus, nu in (ball, plane))
    )


def oblique_ball(vn: float, vt: float, mu: float, e: float, radius: float) -> tuple[float, float]:
    """Tangential speed (m/s) and spin (rad/s) of a solid ball after a bounce without spin before:
    vt - mu (1+e) vn and 2.5 mu (1+e) vn / R while it slips throughout, vt/vn > 3.5 mu (1+e); else
    it leaves rolling, at 5/7 vt (Goldsmith, Impact, 1960, section 2.5; rigid in the tangential
    direction)."""
    loss = min(mu * (1.0 + e) * vn, 2.0 / 7.0 * vt)
    return vt - loss, 2.5 * loss / radius


def hunt_crossley_restitution(av: float) -> float:
    """Restitution on F = k p^n (1 + a p') from a v (1 + e) = ln[(1 + a v)/(1 - a v e)] (Hunt and
    Crossley, J. Appl. Mech. 42, 1975); independent of k, m and n."""
    upper = min(1.0, 1.0 / av) * (1.0 - 1e-15)
    return brentq(
        lambda e: av * (1.0 + e) - math.log((1.0 + av) / (1.0 - av * e)), 1e-9, upper, xtol=1e-15
    )


def linear_restitution(zeta: float) -> float:
    """Restitution of a spring-damper that never pulls: exp[-(z/s)(pi - atan2(2zs, 1-2z^2))], s =
    sqrt(1-z^2) (Schwager and Poeschel, Granular Matter 9, 2007)."""
    s = math.sqrt(1.0 - zeta * zeta)
    return math.exp(-(zeta / s) * (math.pi - math.atan2(2.0 * zeta * s, 1.0 - 2.0 * zeta * zeta)))


def bouncing_ball(height: float, e: float, g: float, contacts: int) -> dict[str, float]:
    """Time (s) and path (m) until rest: sqrt(2h/g)(1+e)/(1-e), h(1+e^2)/(1-e^2), and the time of
    contact number ``contacts``."""
    fall = math.sqrt(2.0 * height / g)
    return {
        "rest": fall * (1.0 + e) / (1.0 - e),
        "path": height * (1.0 + e * e) / (1.0 - e * e),
        "contact": fall + 2.0 * fall * sum(e**i for i in range(1, contacts)),
    }


def explicit_euler_restitution(force, mass: float, v: float, dt: float) -> float:
    """Control: restitution that explicit Euler gives for m p'' = -force(p, p') at the fixed step
    ``dt`` (s)."""
    p, q = 0.0, v
    while True:
        p, q = p + dt * q, q - dt * force(p, q) / mass
        if p <= 0.0:
            return -q / v
