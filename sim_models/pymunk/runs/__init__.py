"""Runs of pymunk through all samples, one for each level of the extrapolation, and their checks."""
