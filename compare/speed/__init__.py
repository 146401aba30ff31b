"""Speed against error: ladders of settings, the clock, and what they say."""
