"""Drawing: the style of all figures, and the figure of one run.

In come numbers with their names; out go figures of matplotlib. No simulation, no files but figures.
"""
