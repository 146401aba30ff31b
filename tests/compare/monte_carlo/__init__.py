"""Tests of tolerances."""
