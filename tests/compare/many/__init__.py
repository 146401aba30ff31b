"""Tests of compare/measure/many: families, and machines drawn from tolerances."""
