"""Speed of both solvers against what one would write today."""
