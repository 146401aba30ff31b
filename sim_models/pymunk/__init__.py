"""pymunk: an impulse-based physics engine as a second-order solver. The engine's entry is `engine.py`."""
