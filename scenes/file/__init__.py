"""Scene files: how they are written, read, checked and changed."""
