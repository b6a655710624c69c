"""What the core computes: one run, batches, one method on many parts.

In come models, out go finished runs as numbers and columns. Nothing here is written to files.
"""
