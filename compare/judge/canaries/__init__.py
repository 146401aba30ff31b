"""The checker is checked: copies of the motions just judged that are wrong on purpose, which it has to notice."""
