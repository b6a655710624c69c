"""What can be described: scenarios, populations, methods, stacks, and the presets that come along.

In comes TOML, out go checked, immutable models. Nothing here is computed, run or drawn.
"""
