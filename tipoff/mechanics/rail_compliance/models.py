"""The models of the surrogate that a rail compliance allows."""

