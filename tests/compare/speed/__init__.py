"""Tests of compare/speed."""
