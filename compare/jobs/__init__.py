"""What `python -m compare.run` does with a scene: reports on it, on a family of it, on draws from its tolerances."""
