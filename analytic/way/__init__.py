"""What the drive's way holds: how far it goes, singular configurations on it, a slider's dead points, the way back."""
