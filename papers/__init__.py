"""The two source papers: their formulas, the audit of every claim, and the clamp's optimisation again."""
