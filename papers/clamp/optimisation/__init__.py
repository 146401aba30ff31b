"""The double-toggle clamp's design optimised again: as its source does it, and beyond."""
