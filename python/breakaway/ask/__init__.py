"""Questions that take many runs: studies, tuning, comparisons of methods, the paper reproduced.

In come files that ask, out go folders that answer, and outlive a kill. No step equations here.
"""
