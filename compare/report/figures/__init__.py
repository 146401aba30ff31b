"""Every figure as plain data, and how figures look."""
