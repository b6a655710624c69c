"""What all tests share."""

from hypothesis import settings

# The same examples in every run, on every machine, however slow it is.
settings.register_profile("breakaway", derandomize=True, deadline=None, database=None)
settings.load_profile("breakaway")
