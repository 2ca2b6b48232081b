"""Results of a run of either solver: its trajectory, what it says as text, its files for other codes."""
