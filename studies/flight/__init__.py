"""After separation: free rotation, relative motion in orbit, clearance of boxes, and what they say of a payload that left its rail."""
