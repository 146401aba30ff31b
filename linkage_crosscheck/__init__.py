"""What other programs import by the name of the distribution: the pytest plug-in."""
