"""Faults of a log that intervals do not know: found before a fit, named, and modeled or warned of."""
