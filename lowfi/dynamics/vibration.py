"""Vibration of the rails in the time loop. Without compliant contact, a kernel contains no code
of it."""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import free_vibration, neglected


@kernel
def advance_free_modes(compliance, touching, dt, start, end, with_work):
    """Fill the modes of rails without a ``touching`` (f,) face in ``end``, ``dt`` (s) after ``start``,
    and add the work of damping if there is damping."""
    if compliance is not None:
        free_vibration.advance(compliance, touching, dt, start, end, with_work)


@kernel
def longest_step(compliance, touching, engaged, before, state):
    """Longest step (s) from ``state`` at which vibration cannot hide a touch of an ``engaged`` (f,)
    face, by the survey ``before`` (f, SURVEY_SIZE); infinite without a near face."""
    longest = np.inf
    if compliance is not None:
        longest = free_vibration.longest_step(
            compliance.modes, compliance.rail, touching, engaged, before, state
        )
    return longest


@kernel
def shortened(compliance, touching, engaged, before, after, state, dt):
    """``dt`` (s), or a shorter step to try if a face comes near a vibrating wall in it."""
    if compliance is not None:
        free = free_vibration.Faces(compliance.rail, touching, engaged, before, after)
        dt = free_vibration.shortened(compliance.modes, free, state, dt)
    return dt


@kernel
def reset_neglected(watched):
    """Bring the neglected modes that are ``watched`` to rest."""
    if watched is not None:
        neglected.reset(watched)


@kernel
def follow_neglected(watched, system, loop):
    """Drive the neglected modes that are ``watched`` through the last step."""
    if watched is not None and watched.effect.size > 0:
        neglected.follow(watched, system, loop)
