"""Exudyn: a multibody DAE code with Lagrange multipliers. The engine's entry is `engine.py`."""
