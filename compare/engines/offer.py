"""Settings of engines from outside, without their code: what a process that does not import an engine knows of them."""

import pickle
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, make_dataclass, replace
from functools import cache
from multiprocessing.reduction import ForkingPickler
from typing import Annotated, Any, get_type_hints

from scenes import Settings

from .reasons import text_of


@dataclass(frozen=True)
class Offer:
    """An engine's settings as plain data, and packed, as they can be read where the engine is imported alone."""

    packed: bytes
    values: tuple[tuple[str, Any], ...]  # by name
    meanings: tuple[str, ...] = field(compare=False)


def offer(settings: Settings) -> Offer:
    """Return settings as plain data."""
    hints: Mapping[str, Any] = {}
    with suppress(Exception):  # annotations may be of anything
        hints = get_type_hints(type(settings), include_extras=True)
    names = [field.name for field in fields(settings)]
    values = tuple((name, _plain(getattr(settings, name))) for name in names)
    meanings = tuple(text_of(getattr(hints.get(name), "__metadata__", ("",))[0]) for name in names)
    return Offer(bytes(ForkingPickler.dumps(settings)), values, meanings)


def _plain(value: object) -> object:
    for kind in (bool, int, float):
        if isinstance(value, kind):
            return kind(value)
    return None if value is None else text_of(value)


@cache
def stand_in(offered: Offer) -> Settings:
    """Return settings of the same values and meanings, of a class of their own."""
    known = {field.name for field in fields(Settings)}
    more = [
        (name, Annotated[type(value), meaning])
        for (name, value), meaning in zip(offered.values, offered.meanings, strict=True)
        if name not in known
    ]
    own = {"offered": offered, "__reduce__": lambda self: (again, (offered, self.promise))}
    kind = make_dataclass("StandIn", more, bases=(Settings,), namespace=own, frozen=True, kw_only=True)
    made: Settings = kind(**dict(offered.values))
    return made


def again(offered: Offer, promise: float) -> Settings:
    """Return what stands in for an engine's settings, with another promise."""
    return replace(stand_in(offered), promise=promise)


def own(settings: Settings) -> Settings:
    """Return the engine's own settings, where these stand in for them."""
    offered: Offer | None = getattr(settings, "offered", None)
    return settings if offered is None else replace(pickle.loads(offered.packed), promise=settings.promise)
