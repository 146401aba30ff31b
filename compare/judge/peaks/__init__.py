"""The numbers by which a designer sizes a linkage, each with its place, and by how much the engines differ on it."""
