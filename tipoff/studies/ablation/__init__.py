"""Every effect off, one at a time: what it changes and what it costs."""
