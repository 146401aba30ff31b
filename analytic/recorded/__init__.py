"""The core's formulas recorded once as a straight line, and the arithmetics that run it.

This is a small tracer like autograd's, a box in place of samples (`traced`), a node for an operation (`expressions`), a
table of rules (`forward`, `walk`), since no library serves: on a processor JAX takes 4 to 6 times as long.
"""
