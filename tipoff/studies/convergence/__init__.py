"""Error of the reference itself: quantities over ever finer meshes, and what they tend to."""
