"""The settings that engines offer: by name, and all whose speed is measured against their error."""

from collections.abc import Mapping
from typing import TypeAlias

from scenes import Settings

from . import registry

TIERS = ("fast", "balanced", "exact")  # settings by name
Accuracy: TypeAlias = str | float  # one of `TIERS`, or the largest relative error

LADDER, ABLATION = "ladder", "ablation"  # roles of settings: from coarse to fine, and with more than a scene needs


def tiers(engine: str) -> Mapping[str, Settings]:
    """Return the settings that an engine offers by name, from the fastest to the most accurate."""
    module = registry.engine(engine)
    return dict(zip(TIERS, (module.FAST, module.DEFAULT, module.EXACT), strict=True))


def settings_of(engine: str, *, long_ladders: bool) -> Mapping[Settings, str]:
    """Return all settings of an engine with the role of each; `long_ladders` adds those that only `--full` takes."""
    module = registry.engine(engine)
    if not long_ladders:
        return dict.fromkeys(module.LADDER, LADDER)
    ladder = dict.fromkeys((*module.LADDER, *module.LONG_LADDER, *tiers(engine).values()), LADDER)
    return dict.fromkeys(module.ABLATIONS, ABLATION) | ladder
