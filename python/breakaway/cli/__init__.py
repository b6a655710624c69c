"""The ``breakaway`` command: one file for each of its commands, listed in `app.py`.

In come words and files; out go tables, JSON and exit codes. It asks the API and computes nothing.
"""
