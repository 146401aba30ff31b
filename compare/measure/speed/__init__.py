"""Speed against error: settings, the clock, and what follows from both."""
