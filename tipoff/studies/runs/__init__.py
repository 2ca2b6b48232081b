"""Every condition of a scene in either model, and single runs."""
