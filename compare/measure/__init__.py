"""What is measured of engines: speed against error, hard cases, many linkages. No figure, no table of the page."""
