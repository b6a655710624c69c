"""Faults of a log that intervals do not know: found, named, and modeled or warned of."""
