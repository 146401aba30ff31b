"""Tests of compare/ci."""
