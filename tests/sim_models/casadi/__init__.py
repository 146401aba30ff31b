"""Tests of the CasADi model."""
