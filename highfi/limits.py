"""The critical step of the coupled system: rail, penalty contact, payload.

Contact adds G k G' to the stiffness, where a column of G is the gap of one Gauss point. In the mass metric

    lambda_max(rail + contact) <= lambda_max(rail) + k_p [max over nodes (area_a / m_a) + sum over faces A (1/m + r'I^-1 r)]

because the largest eigenvalue of a sum is at most the sum, and that of G k G' on the nodes alone is at most the largest sum of
magnitudes in a row of M^-1 G k G' (Gershgorin):

    sum over b of |sum over points of A N_a N_b| / m_a <= area_a / m_a,    area_a = sum over points of A |N_a| sum over b of |N_b|

On bilinear facets no N is negative and their sum is one, so area_a is the node's own share of the area; on quadratic triangles the
corners' N may be negative and the last sum reaches 5/3. A step is stable for dt^2 lambda/4 + (dt/2) max(c/m) <= 1 with
velocity-dependent friction lagged half a step, where c of a node is bounded by the same sum with each point's damping in place of
its area; that term is watched during the run.
"""

import numpy as np

from highfi.system import System


def contact_frequency_squared(system: System) -> float:
    """Upper bound (1/s2) of what contact adds to the largest squared frequency."""
    if system.model.penalty is None:
        return 0.0
    surface, rail, payload = system.surface, system.rail, system.model.payload
    area = np.zeros(rail.mass.size)
    for node in range(surface.facets.shape[1]):
        np.add.at(area, surface.facets[:, node], surface.area @ surface.spread[:, node])
    faces = system.faces
    size = 4.0 * faces.half_length * faces.half_width
    reach = (faces.centre**2).sum(axis=1) * np.linalg.eigvalsh(payload.inverse_inertia)[-1]
    # The crown tilts the normal by at most 4 relief / half length: its gradient is longer than one by this factor.
    tilt = 1.0 + ((4.0 * faces.relief / faces.half_length) ** 2 + (4.0 * faces.relief / faces.half_width) ** 2).max()
    body = (size * (1.0 / payload.mass + reach)).sum()
    return system.model.penalty * tilt * ((area * rail.inverse_mass).max() + body)
