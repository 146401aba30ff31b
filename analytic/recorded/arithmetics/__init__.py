"""What runs a recorded line: NumPy, machine code, Taylor models; JavaScript is in `page`."""
