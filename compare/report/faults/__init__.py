"""The page of faults: what was wrong on purpose, and what the comparison made of it."""
