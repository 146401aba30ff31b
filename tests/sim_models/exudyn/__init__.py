"""Tests of sim_models/exudyn."""
