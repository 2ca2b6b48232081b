"""Drop tests: from the log of an inertial unit to the change of rate at ejection with its uncertainty, and what that says of a
model."""
