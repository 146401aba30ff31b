"""Tests of compare/judge."""
