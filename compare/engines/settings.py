"""The settings that engines offer: by name, and all whose speed is measured against their error."""

from collections.abc import Mapping
from typing import TypeAlias

from scenes import Settings

from . import registry

TIERS = ("fast", "balanced", "exact")  # settings by name
Accuracy: TypeAlias = str | float  # one of `TIERS`, or the largest relative error

# Roles of settings: from cheap to accurate, and with more than a scene needs.
WORK_PRECISION, ABLATION = "work-precision", "ablation"


def tiers(engine: str) -> Mapping[str, Settings]:
    """Return the settings that an engine offers by name, from the fastest to the most accurate."""
    module = registry.engine(engine)
    return dict(zip(TIERS, (module.FAST, module.DEFAULT, module.EXACT), strict=True))


def settings_of(engine: str, *, full: bool) -> Mapping[Settings, str]:
    """Return all settings of an engine with the role of each; `full` adds those that only `--full` takes."""
    module = registry.engine(engine)
    if not full:
        return dict.fromkeys(module.WORK_PRECISION, WORK_PRECISION)
    settings = (*module.WORK_PRECISION, *module.LONG_WORK_PRECISION, *tiers(engine).values())
    return dict.fromkeys(module.ABLATIONS, ABLATION) | dict.fromkeys(settings, WORK_PRECISION)
