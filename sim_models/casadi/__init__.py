"""CasADi: Lagrange's equations of the first kind, all derivatives by its differentiation. The entry is `engine.py`."""
