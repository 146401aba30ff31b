"""Larger groups: their equations, the solution by Newton's method, and the branch followed over the drive's way."""
