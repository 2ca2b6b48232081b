"""The internal force of an extruded mesh, section point by section point."""
