"""What is wrong on purpose: motions, scenes, code, engines and files, and processes that are killed."""
