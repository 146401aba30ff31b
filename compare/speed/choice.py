"""The settings of an engine's main run, by the accuracy that was asked for."""

import pandas as pd

from scenes import Settings

from .ladders import settings_of, tiers
from .work_precision import cheapest, groups, solved


def offered(engine: str, tier: str) -> tuple[Settings, str]:
    """Return an engine's settings of that name, and what a reader has to know about them."""
    settings = tiers(engine)[tier]
    return settings, _noted(engine, settings)


def cheapest_within(engine: str, accuracy: float, speed: pd.DataFrame) -> tuple[Settings, str]:
    """Return the cheapest settings that were measured to meet an accuracy in every group, without a note; and why.

    Where none were, these are the most accurate.
    """
    points = solved(speed)
    own = points[(points["engine"] == engine) & (points["note"] == "")]
    own = own.assign(worst=own[[f"{group}_max" for group in groups(speed)]].max(axis=1, skipna=False))
    best = cheapest(own, "worst", accuracy)
    if best is None:
        why = f"no setting was measured to be within {accuracy:g} in every group; run at its most accurate one"
        settings, note = offered(engine, "exact")
        return settings, "; ".join(filter(None, (f"{engine}: {why}", note)))
    settings = next(s for s in settings_of(engine, long_ladders=True) if s.label == best["setting"])
    return settings, f"{engine}: {settings.label} is the cheapest measured to be within {accuracy:g} in every group"


def _noted(engine: str, settings: Settings) -> str:
    return f"{engine}, {settings.label}: {settings.note}" if settings.note else ""
