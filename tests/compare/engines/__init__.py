"""Tests of compare/engines."""
