"""Tests of analytic."""
