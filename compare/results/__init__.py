"""Results of other programs, read from text tables: they stand beside the engines and are judged as these are."""
