"""Speed against error, as shown."""
