"""Names in result files that other tools read. A change of one is a change of a file format."""

ARRAYS = (  # of a trajectory of the surrogate
    "time",
    "position",
    "velocity",
    "quaternion",
    "rate",
    "platform_position",
    "platform_velocity",
    "platform_quaternion",
    "platform_rate",
    "pad_force",
    "energy",
    "transverse_energy",
)
ARRAYS_OF_REFERENCE = (*ARRAYS, "wall_stress")
RUN_ROW = {
    "condition",
    "status",
    "wall_s",
    "compile_s",
    "steps",
    "dt_s",
    "energy_error",
    "transverse_energy_error",
    "linear_momentum_error",
    "angular_momentum_error",
    "settled",
    "trajectory",
    "thrust",
}
