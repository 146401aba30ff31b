"""Tolerances of the workshop: many machines with numbers drawn from them, and what they do to the designer's."""
