"""Settings of engines from outside, without their code: what a process that does not import an engine knows of them."""

import pickle
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields, make_dataclass, replace
from functools import cache
from multiprocessing.reduction import ForkingPickler
from typing import Annotated, Any, ClassVar, TypeAlias, get_type_hints

from scenes import Settings

from .reasons import text_of

Meanings: TypeAlias = tuple[tuple[str, str], ...]  # by name of a field


class StandIn(Settings):
    """Settings of plain values, with the names and meanings of an engine's own, in a class of their own."""

    packed: ClassVar[bytes]  # the engine's own, as they can be read where it is imported alone
    meanings: ClassVar[Meanings]

    def __reduce__(self) -> tuple[object, ...]:
        """Return what they are made of again in another process."""
        return standing, (self.packed, self.meanings, vars(self))


def stand_in(settings: Settings) -> Settings:
    """Return what stands in for an engine's settings."""
    if isinstance(settings, StandIn):
        return settings
    hints: Mapping[str, Any] = {}
    with suppress(Exception):  # annotations may be of anything
        hints = get_type_hints(type(settings), include_extras=True)
    names = [field.name for field in fields(settings)]
    meanings = tuple((name, text_of(getattr(hints.get(name), "__metadata__", ("",))[0])) for name in names)
    values = {name: _plain(getattr(settings, name)) for name in names}
    return standing(bytes(ForkingPickler.dumps(settings)), meanings, values)


def _plain(value: object) -> object:
    for kind in (bool, int, float):
        if isinstance(value, kind):
            return kind(value)
    return None if value is None else text_of(value)


def standing(packed: bytes, meanings: Meanings, values: Mapping[str, Any]) -> Settings:
    """Return what stands in for settings that are packed, by the meanings and values of their fields."""
    return _kind(packed, meanings)(**values)


@cache
def _kind(packed: bytes, meanings: Meanings) -> type[Settings]:
    known = {field.name for field in fields(Settings)}
    more = [(name, Annotated[Any, meaning]) for name, meaning in meanings if name not in known]
    own = {"packed": packed, "meanings": meanings}
    return make_dataclass("StandIn", more, bases=(StandIn,), namespace=own, frozen=True, kw_only=True)


def own(settings: Settings) -> Settings:
    """Return the engine's own settings, where these stand in for them."""
    if not isinstance(settings, StandIn):
        return settings
    unpacked: Settings = pickle.loads(settings.packed)
    return replace(unpacked, promise=settings.promise)
