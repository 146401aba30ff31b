"""Tests of sim_models."""
