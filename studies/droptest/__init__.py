"""Drop tests: from the log of an inertial unit to the change of rate by ejection, and what that
says of a model."""
