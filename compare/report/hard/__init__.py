"""Hard cases and maps of stability, as shown."""
