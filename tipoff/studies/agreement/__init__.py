"""How far two trajectories are apart, what that is judged by, and how long it means anything."""
