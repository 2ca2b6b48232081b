"""Closed forms of thermo-elasticity: Timoshenko and Goodier, Theory of Elasticity, 3rd ed. 1970,
chapter 13; Boley and Weiner, Theory of Thermal Stresses, 1960, section 9.6: a simply connected body
is free of stress if its temperature is linear in place."""


def free_displacement(places, strain, gradient):
    """Displacement (n,3) m of a free body by the free strain ``strain + gradient . X``, up to a
    rigid motion: the one field with strain_ij = delta_ij (strain + gradient . X)."""
    here = strain + places @ gradient
    return here[:, None] * places - 0.5 * (places**2).sum(axis=1, keepdims=True) * gradient


def bow(curvature, length):
    """Deflection (m) at the end of a strip of ``length`` (m) held at its root: k L^2 / 2."""
    return 0.5 * curvature * length**2


def clamped_stress(youngs_modulus, poisson_ratio, strain, held):
    """Stress (Pa) along x of a bar held in 1, 2 or 3 directions: -E e / (1 - (held - 1) nu)."""
    return -youngs_modulus * strain / (1.0 - (held - 1) * poisson_ratio)
