"""Measures, compares, reports. Reaches the models by name only, through `registry`."""
