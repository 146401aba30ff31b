"""Tests of compare/family."""
