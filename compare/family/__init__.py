"""Families of scenes: members that differ in some numbers."""
