"""Tests of compare/mechanics."""
