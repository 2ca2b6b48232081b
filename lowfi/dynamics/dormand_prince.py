"""The embedded Runge-Kutta pair of Dormand and Prince, order 5(4), with Shampine's interpolant of
order four.

    k_i = f(t + c_i h, y + h sum_j a_ij k_j),    y(t + theta h) = y + h sum_i b_i(theta) k_i,    error = h sum_i e_i k_i

The last stage is the first of the next step. Sources: Dormand and Prince, J. Comp. Appl. Math. 6
(1980) 19; Shampine, Math. Comp. 46 (1986) 135. For y' = z y the method multiplies y by R(z) = 1 + z
+ z^2/2 + z^3/6 + z^4/24 + z^5/120 + z^6/600, and |R| <= 1 on the whole half disc |z| <=
STABLE_RADIUS, Re z <= 0: no linear mode, oscillating or damped, grows while h |eigenvalue| stays
below it.
"""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.dynamics.equations import derivative
from tipoff.lowfi.dynamics.vibration import advance_free_modes
from tipoff.lowfi.state import (
    DYNAMIC_SIZE,
    PAYLOAD,
    PLATFORM,
    STATE_SIZE,
    copy,
    modal_size,
    normalise,
    reconcile,
)

STAGES = 7
STABLE_RADIUS = 0.95

NODES = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
MATRIX = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
ERROR = np.array([-71 / 57600, 0.0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
DENSE = np.array(
    [
        [1.0, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0.0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0.0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
        [0.0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0.0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ]
)


@kernel
def attempt(system, loop, stretch, time, dt, fresh):
    """Advance ``loop.start`` at ``time`` (s) to ``loop.end`` at ``time + dt``; unless ``fresh``,
    ``loop.stages`` already has k_1.

    Thrust is evaluated within ``stretch`` (s), the open interval between two corners, even if
    rounded stage times are beyond it.
    """
    start, stages, end = loop.start, loop.stages, loop.end
    for stage in range(0 if fresh else 1, STAGES):
        _combine(stage, dt, start, stages, end)
        _combine_modes(stage, dt, start, stages, modal_size(system.compliance), end)
        if stage == STAGES - 1:
            _restore(system, loop.counts.apart, dt, end)
            advance_free_modes(system.compliance, loop.touching, dt, start, end, True)
        derivative(
            system,
            loop.touching,
            loop.stick,
            loop.counts.apart,
            min(max(time + NODES[stage] * dt, stretch[0]), stretch[1]),
            end,
            stages[stage],
        )


@kernel
def _restore(system, apart, dt, state):
    """Restore properties that the sum of stages of a step of ``dt`` (s) does not conserve: unit
    quaternions, and rates that agree with the momenta."""
    normalise(state)
    reconcile(system.payload, apart, dt, state, PAYLOAD)
    _reconcile_platform(system.platform, apart, dt, state)


@kernel
def _reconcile_platform(platform, apart, dt, state):
    if platform.free:
        reconcile(platform, apart, dt, state, PLATFORM)


@kernel
def _combine(stage, h, y, k, out):
    """out = y + h sum_j a_stage,j k_j, each sum in one pass over the slots; quadratures only at the
    end of the step."""
    if stage == 0:
        copy(y, out, STATE_SIZE)
    elif stage == 1:
        for j in range(DYNAMIC_SIZE):
            out[j] = y[j] + h * (MATRIX[1, 0] * k[0, j])
    elif stage == 2:
        for j in range(DYNAMIC_SIZE):
            out[j] = y[j] + h * (MATRIX[2, 0] * k[0, j] + MATRIX[2, 1] * k[1, j])
    elif stage == 3:
        for j in range(DYNAMIC_SIZE):
            out[j] = y[j] + h * (
                MATRIX[3, 0] * k[0, j] + MATRIX[3, 1] * k[1, j] + MATRIX[3, 2] * k[2, j]
            )
    elif stage == 4:
        for j in range(DYNAMIC_SIZE):
            out[j] = y[j] + h * (
                MATRIX[4, 0] * k[0, j]
                + MATRIX[4, 1] * k[1, j]
                + MATRIX[4, 2] * k[2, j]
                + MATRIX[4, 3] * k[3, j]
            )
    elif stage == 5:
        for j in range(DYNAMIC_SIZE):
            out[j] = y[j] + h * (
                MATRIX[5, 0] * k[0, j]
                + MATRIX[5, 1] * k[1, j]
                + MATRIX[5, 2] * k[2, j]
                + MATRIX[5, 3] * k[3, j]
                + MATRIX[5, 4] * k[4, j]
            )
    else:
        for j in range(STATE_SIZE):
            out[j] = y[j] + h * (
                MATRIX[6, 0] * k[0, j]
                + MATRIX[6, 2] * k[2, j]
                + MATRIX[6, 3] * k[3, j]
                + MATRIX[6, 4] * k[4, j]
                + MATRIX[6, 5] * k[5, j]
            )


@kernel
def _combine_modes(stage, h, y, k, modal, out):
    """As ``_combine``, for the ``modal`` numbers of the rails' modes."""
    for j in range(STATE_SIZE, STATE_SIZE + modal):
        total = 0.0
        for i in range(min(stage, STAGES - 1)):
            total += MATRIX[stage, i] * k[i, j]
        out[j] = y[j] + h * total


@kernel
def local_error(h, k, modal, out):
    """Difference of the two orders in every dynamic slot of ``out``, and in those of ``modal``
    numbers of modes."""
    for j in range(DYNAMIC_SIZE):
        out[j] = _difference(h, k, j)
    for j in range(STATE_SIZE, STATE_SIZE + modal):
        out[j] = _difference(h, k, j)


@kernel
def _difference(h, k, j):
    return h * (
        ERROR[0] * k[0, j]
        + ERROR[2] * k[2, j]
        + ERROR[3] * k[3, j]
        + ERROR[4] * k[4, j]
        + ERROR[5] * k[5, j]
        + ERROR[6] * k[6, j]
    )


@kernel
def interpolate(system, loop, dt, theta, size, out):
    """The first ``size`` slots of the state, at least MOVING_SIZE, and the modes of the rails, at
    ``theta`` in 0..1 of the step of ``dt`` (s) in ``loop``."""
    start, stages, h = loop.start, loop.stages, dt * theta
    b0, b2, b3, b4, b5, b6 = (
        _polynomial(0, theta),
        _polynomial(2, theta),
        _polynomial(3, theta),
        _polynomial(4, theta),
        _polynomial(5, theta),
        _polynomial(6, theta),
    )
    for j in range(size):
        out[j] = start[j] + h * (
            b0 * stages[0, j]
            + b2 * stages[2, j]
            + b3 * stages[3, j]
            + b4 * stages[4, j]
            + b5 * stages[5, j]
            + b6 * stages[6, j]
        )
    for j in range(STATE_SIZE, STATE_SIZE + modal_size(system.compliance)):
        out[j] = start[j] + h * (
            b0 * stages[0, j]
            + b2 * stages[2, j]
            + b3 * stages[3, j]
            + b4 * stages[4, j]
            + b5 * stages[5, j]
            + b6 * stages[6, j]
        )
    _restore(system, loop.counts.apart, dt, out)
    advance_free_modes(system.compliance, loop.touching, h, start, out, size == STATE_SIZE)


@kernel
def _polynomial(stage, theta):
    return DENSE[stage, 0] + theta * (
        DENSE[stage, 1] + theta * (DENSE[stage, 2] + theta * DENSE[stage, 3])
    )
