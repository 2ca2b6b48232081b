"""Internal force of an extruded mesh, column by column."""
