"""The embedded Runge-Kutta pair of Dormand and Prince, order 5(4), with Shampine's interpolant of order four.

    k_i = f(t + c_i h, y + h sum_j a_ij k_j),    y(t + theta h) = y + h sum_i b_i(theta) k_i,    error = h sum_i e_i k_i

The last stage is the first of the next step. Sources: Dormand and Prince, J. Comp. Appl. Math. 6 (1980) 19; Shampine, Math. Comp. 46
(1986) 135. For y' = z y the method multiplies y by R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 + z^5/120 + z^6/600, and |R| <= 1 on the
whole half disc |z| <= STABLE_RADIUS, Re z <= 0: no linear mode, oscillating or damped, grows while h |eigenvalue| stays below it.
"""

import numpy as np

from lowfi.equations import derivative
from lowfi.state import DYNAMIC_SIZE, STATE_SIZE, copy, normalise
from scenes.jit import inlined

STAGES = 7
STABLE_RADIUS = 0.95

NODES = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
MATRIX = np.array([
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
    [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
    [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]])
ERROR = np.array([-71 / 57600, 0.0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
DENSE = np.array([
    [1.0, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
    [0.0, 0.0, 0.0, 0.0],
    [0.0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
    [0.0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
    [0.0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
    [0.0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
    [0.0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423]])


@inlined
def attempt(system, active, stretch, time, dt, fresh, start, stages, end):
    """From ``start`` (STATE_SIZE,) at ``time`` to ``end`` at ``time + dt``; unless ``fresh``, ``stages`` (7, STATE_SIZE) holds k_1.

    Thrust is taken inside ``stretch`` (s), open between two corners, whatever rounding does to stage times.
    """
    for stage in range(0 if fresh else 1, STAGES):
        size = STATE_SIZE if stage == STAGES - 1 else DYNAMIC_SIZE
        copy(start, end, size)
        for i in range(stage):
            weight = dt * MATRIX[stage, i]
            if weight != 0.0:
                for j in range(size):
                    end[j] += weight * stages[i, j]
        if stage == STAGES - 1:
            normalise(end)
        derivative(system, active, min(max(time + NODES[stage] * dt, stretch[0]), stretch[1]), end, stages[stage])


@inlined
def interpolate(dt, theta, start, stages, size, out):
    """The first ``size`` slots of the state at ``theta`` in 0..1 of a step."""
    copy(start, out, size)
    for i in range(STAGES):
        weight = dt * theta * (DENSE[i, 0] + theta * (DENSE[i, 1] + theta * (DENSE[i, 2] + theta * DENSE[i, 3])))
        if weight != 0.0:
            for j in range(size):
                out[j] += weight * stages[i, j]
    normalise(out)
