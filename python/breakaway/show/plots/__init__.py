"""Figures, in one style; nothing here touches matplotlib's global state for longer than a call."""
