"""Tests of what holds between the samples too."""
