"""Newton and Newton-Euler at 50 digits: certifies the reference. The engine's entry is `engine.py`."""
