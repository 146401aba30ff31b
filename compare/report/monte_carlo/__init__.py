"""Tolerances, as shown."""
