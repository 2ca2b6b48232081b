"""The surrogate's contact taken from the finite elements: rail compliance, constants of springs."""
