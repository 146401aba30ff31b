"""The linkage as the page solves it, for numbers that its reader changes."""
