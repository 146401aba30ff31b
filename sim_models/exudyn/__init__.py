"""Exudyn: a multibody DAE code with Lagrange multipliers. The engine's entry is `engine.py`."""

import os

os.environ["EXUDYN_NO_USER_SETTINGS"] = "1"  # which it would read on import, for interactive work
