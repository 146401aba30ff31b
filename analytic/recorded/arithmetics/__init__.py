"""What runs a recorded line: NumPy, and machine code; each spells the operations of `walk` in its own words."""
