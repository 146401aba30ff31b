"""Tests of compare/results."""
