"""The settings of an engine's main run, by the accuracy that was asked for."""

import pandas as pd

from scenes import Settings

from .asked import Accuracy
from .speed import settings_of, tiers
from .work_precision import cheapest, groups, solved


def chosen(engine: str, accuracy: Accuracy, speed: pd.DataFrame) -> tuple[Settings, str]:
    """Return an engine's settings, and what a reader has to know about them.

    For a number these are the cheapest that were measured to meet it in every channel group, without a note.
    """
    offered = tiers(engine)
    if isinstance(accuracy, str):
        return offered[accuracy], _noted(engine, offered[accuracy])
    points = solved(speed)
    own = points[(points["engine"] == engine) & (points["note"] == "")]
    own = own.assign(worst=own[[f"{group}_max" for group in groups(speed)]].max(axis=1, skipna=False))
    best = cheapest(own, "worst", accuracy)
    if best is None:
        why = f"no setting was measured to be within {accuracy:g} in every group; run at its most accurate one"
        return offered["exact"], "; ".join(filter(None, (f"{engine}: {why}", _noted(engine, offered["exact"]))))
    settings = next(s for s in settings_of(engine, long_ladders=True) if s.label == best["setting"])
    return settings, f"{engine}: {settings.label} is the cheapest measured to be within {accuracy:g} in every group"


def _noted(engine: str, settings: Settings) -> str:
    return f"{engine}, {settings.label}: {settings.note}" if settings.note else ""
