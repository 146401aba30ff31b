"""Pinocchio: joint coordinates, closed loops, recursive Newton-Euler. The engine's entry is `engine.py`."""
