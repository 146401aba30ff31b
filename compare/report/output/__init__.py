"""The files of results, and how they take their place."""
