"""Engines by name: registry, runner, isolation; motions as vectors; the reference and its floor."""
