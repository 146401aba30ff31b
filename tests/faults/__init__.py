"""The checker is checked: motions, scenes and code that are wrong on purpose, and whether the comparison notices."""
