"""What holds between the samples too: enclosures over whole boxes of the drive's range, and all assemblies."""
