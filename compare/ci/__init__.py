"""What continuous integration asks for: annotations, and what changed since a baseline."""
