"""Which inputs an answer depends on: constants moved one at a time, and Sobol' indices."""
