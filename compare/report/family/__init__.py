"""Families, as shown."""
