"""What is wrong with a run: checks that need no reference first, errors against the reference last."""
