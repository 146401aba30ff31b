"""Every page, table, figure and file."""
