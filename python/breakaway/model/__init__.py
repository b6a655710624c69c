"""What can be described: scenarios, populations, methods, stacks, and the presets that come along.

In comes TOML, out go checked, immutable models, and what the core answers about their friction.
Nothing here is run, drawn or computed by an equation of its own.
"""
