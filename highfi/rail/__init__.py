"""The rail of a scene: its mesh, whether both fit, and the memory a run takes."""
