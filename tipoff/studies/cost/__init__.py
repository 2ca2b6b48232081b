"""What a run takes, how that grows, and which model to choose for an accuracy or a time."""
