"""Every page: its template, and what that is rendered with."""
