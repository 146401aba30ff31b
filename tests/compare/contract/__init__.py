"""Tests of compare/contract."""
