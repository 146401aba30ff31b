"""The double-toggle clamp of a die casting machine: every claim of its source, and its optimisation again."""
