"""What people look at: figures, pages, and the folder of a run.

In come finished results, out go pictures and files. Nothing here is recomputed.
"""
