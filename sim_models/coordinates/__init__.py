"""What the engines of minimal equations share: bodies, assembly and poses; each has its own equations of motion."""
