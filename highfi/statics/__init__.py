"""Linear statics and vibration of a clamped rail: assembly, solutions, loads of pads and heat."""
