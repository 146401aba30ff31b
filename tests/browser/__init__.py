"""Pages in a real browser: reports, families, the bench, and what their buttons do."""
