"""Closed form of the tip-off of a rocket on its last button: a rigid body that slides along the rail
and turns about one point of it, without play.

The button is a distance d behind the mass centre, and g is the acceleration of gravity across the
rail. With the normal force N and small angles, m a = N - m g - F theta with a = -d theta'', and I
theta'' = d N + M. The thrust F along the body drives the angle further::

    (I + m d^2) theta'' = m g d + M + F d theta,   theta' = (a / b) sinh(b t),
    a = (m g d + M) / (I + m d^2),   b^2 = F d / (I + m d^2)

M is the moment of the thrust about the mass centre. Without the share of F this is the pendulum's
start, theta' = a t. Source: any text on rigid bodies; RocketPy solves the same constraint by numbers
(https://docs.rocketpy.org, technical references, Tip-off).
"""

import math


def rate(
    body: tuple[float, float], distance: float, across: float, thrust: float, duration: float
) -> float:
    """Angular rate (rad/s) after ``duration`` (s) from rest, of a body with mass (kg) and inertia
    (kg m2) about its centre, a ``distance`` (m) before the button, under gravity ``across`` (m/s2) and a
    constant ``thrust`` (N) through the centre."""
    mass, inertia = body
    whole = inertia + mass * distance**2
    growth = math.sqrt(thrust * distance / whole)
    return mass * across * distance / whole * math.sinh(growth * duration) / growth


def start(body: tuple[float, float], distance: float, across: float, duration: float) -> float:
    """As ``rate``, without the share of the thrust."""
    mass, inertia = body
    return mass * across * distance * duration / (inertia + mass * distance**2)
