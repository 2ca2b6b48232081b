"""What a user knows of the hardware, and the tables of a scene that follow from it."""
