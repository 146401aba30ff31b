"""The two source papers, audited: what they print against what is computed."""
