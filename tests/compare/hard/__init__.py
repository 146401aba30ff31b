"""Tests of compare/hard."""
