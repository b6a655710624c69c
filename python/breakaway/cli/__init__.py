"""The ``breakaway`` command: it asks the API and shows the answer; it computes nothing itself."""
