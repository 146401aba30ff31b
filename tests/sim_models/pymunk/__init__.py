"""Tests of sim_models/pymunk."""
