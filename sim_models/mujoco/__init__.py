"""MuJoCo: soft constraints, made as hard as a step allows. The engine's entry is `engine.py`."""
