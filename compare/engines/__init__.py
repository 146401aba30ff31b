"""Engines by name: registry, runner, workers in isolation; motions as vectors; the reference and its floor."""

TRACEBACK = "LINKAGE_TRACEBACK"  # environment variable, by which a command shows where an error is
