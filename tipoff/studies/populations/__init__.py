"""Many cases at once: what is drawn, what is kept of each, and what independent draws say."""
