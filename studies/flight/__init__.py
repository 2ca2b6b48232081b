"""After separation: free rotation, relative motion in orbit, clearance of boxes, and what becomes
of a payload."""
