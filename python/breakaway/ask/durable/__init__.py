"""Durable: long work in a folder that outlives a kill, whatever the work is.

In comes what determines the results, as a manifest, and what is computed, piece by piece. Out goes
a folder whose bytes are the same whether the work was ended in between or not. Nothing here knows
studies, tunings or comparisons, or what a piece means.
"""
