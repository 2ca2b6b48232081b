"""What every compiled kernel rests on: compilation, aligned arrays, rotations."""
