"""What a model is asked for and has to return, and what any of them may use."""
