"""Tests of sim_models/multiprecision."""
