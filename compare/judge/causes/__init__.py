"""Hypotheses of what is wrong with a motion, a family of causes a file: each predicts what the motion would then be."""
