"""The two routes: integrated in time, or solved at instants."""
