"""What the command line asks for, and what is done with a scene: a report, a family, draws from its tolerances."""
