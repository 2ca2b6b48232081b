"""The deepest cell of a pad face, pressed or not (``cells`` has p of a cell)."""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import patterns
from tipoff.lowfi.contact.compliant.cells import along_row, fill_row, row_place
from tipoff.lowfi.contact.compliant.record import ASIDE, BY_ETA, BY_XI

_SURE = 1e-12  # m, and of a depth: more than rounding


@kernel
def deepest(compliance, face, displacement):
    """Largest p (m) of all cells, and xi and eta of that cell on the pad. Off the wall, they are
    those of the whole face, so that a contact in the step in which it leaves is found. Rows that
    cannot hold it, by a bound from one row, are skipped."""
    workspace, relief = compliance.workspace, compliance.relief[face]
    aside, largest, along, across = workspace.lever[face, ASIDE], -np.inf, 0.0, 0.0
    base = _keep_best_row(compliance, face, displacement)
    for row in range(compliance.node.size):
        xi, _, crown = row_place(compliance, face, row)
        fill_row(compliance, face, xi, displacement)
        if _most_above_kept_row(workspace, 1.0 + abs(aside)) - relief * crown < base:
            continue
        for column in range(compliance.node.size):
            eta = compliance.node[column] + aside
            p = along_row(workspace, eta) - relief * (crown + compliance.crown[column])
            if p > largest:
                largest, along, across = p, xi, compliance.node[column]
    return largest, along, across


@kernel
def _keep_best_row(compliance, face, displacement):
    """Keep the row of cells that is deepest in its middle, in ``Workspace.counted``; returns minus
    its crown (m), less by more than rounding."""
    workspace, relief = compliance.workspace, compliance.relief[face]
    best, base = -np.inf, 0.0
    for number in range(compliance.node.size):
        xi, _, crown = row_place(compliance, face, number)
        fill_row(compliance, face, xi, displacement)
        if workspace.row[0] - relief * crown > best:
            best = workspace.row[0] - relief * crown
            base = -relief * crown - _SURE * (1.0 + abs(best))
            for j in range(max(patterns.degree(workspace.levels), 2) + 1):
                workspace.counted[j] = workspace.row[j]
    return base


@kernel
def _most_above_kept_row(workspace, reach):
    """Upper bound (m) of the difference between the filled and the kept row for eta' of a size up to
    ``reach``, without the crown along the row."""
    most, power = workspace.row[0] - workspace.counted[0], 1.0
    for j in range(1, max(patterns.degree(workspace.levels), 2) + 1):
        power *= reach
        most += power * abs(workspace.row[j] - workspace.counted[j])
    return most


@kernel
def deepest_at_rest(compliance, face, displacement):
    """As ``deepest`` for a wall whose ``displacement`` is zero: p is then a sum of a part along and
    a part across the pad. The value has the bits of ``deepest``."""
    lever, relief = compliance.workspace.lever[face], compliance.relief[face]
    along, across, by_xi, by_eta, crown = 0.0, 0.0, -np.inf, -np.inf, 0.0
    column = 0
    for i in range(compliance.node.size):
        xi, _, row_crown = row_place(compliance, face, i)
        if lever[BY_XI] * xi - relief * row_crown > by_xi:
            along, crown, by_xi = xi, row_crown, lever[BY_XI] * xi - relief * row_crown
        place = compliance.node[i]
        if lever[BY_ETA] * place - relief * compliance.crown[i] > by_eta:
            across, column = place, i
            by_eta = lever[BY_ETA] * place - relief * compliance.crown[i]
    fill_row(compliance, face, along, displacement)
    p = along_row(compliance.workspace, across + lever[ASIDE])
    return p - relief * (crown + compliance.crown[column]), along, across
