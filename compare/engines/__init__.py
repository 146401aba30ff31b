"""Engines by name: registry, runner, workers in isolation; motions as vectors; the reference and its floor."""
