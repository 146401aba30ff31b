"""Tests of compare/faults."""
