"""A curve as small as a word, for the tables that a notebook shows."""

import numpy as np

from ..drive import Samples

WIDTH, HEIGHT, MARGIN = 120, 24, 2  # px


def sparkline(values: Samples) -> str:
    """Draw samples, evenly spaced, as an SVG curve in the colour of the text, between their least and largest."""
    shown = values[np.linspace(0, len(values) - 1, min(len(values), WIDTH)).round().astype(int)]
    size = np.ptp(values)
    y = (values.max() - shown) / size if 0 < size < np.inf else np.full(len(shown), 0.5)
    across = np.linspace(MARGIN, WIDTH - MARGIN, len(shown))
    corners = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across, MARGIN + (HEIGHT - 2 * MARGIN) * y, strict=True))
    return (
        f'<svg width="{WIDTH}" height="{HEIGHT}" role="img" aria-label="curve">'
        f'<polyline points="{corners}" fill="none" stroke="currentColor"/></svg>'
    )
