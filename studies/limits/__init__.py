"""Tolerances that keep rates below limits: what is asked, cases within tolerances, the largest that
are certified."""
