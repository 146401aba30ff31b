"""The judge's own model of the linkage: constraints, projection, motion vectors, scales, and the reference in them."""
