"""Speed against error: settings, the clock, and what they say."""
