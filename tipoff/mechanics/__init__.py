"""What both solvers share: records, exit, trajectory, energy and momentum, rail compliance."""
