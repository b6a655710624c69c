"""What every room stands on: text and files of others, files of ours, equality, threads.

In come texts and paths, out go checked texts and whole files. Nothing here knows friction.
"""
