"""What is known by a formula, written once: a table of scenes and of their channels, over which every engine is run."""
