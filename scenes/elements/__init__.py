"""What acts on the bodies besides their weight: loads, springs and friction, a kind or some like ones a file.

A kind is a dataclass with a table in a scene file. Every file of this folder is read, and a kind is known by being in
one: its list in scene files, its numbers with units and signs, what messages call it. What it does to the bodies each
model has in a registry of its own, by type, from which follows which kinds an engine knows.
"""

from collections.abc import Iterable, Mapping
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from ..drive import KINDS as DRIVES
from .element import Element, ElementTable

for _module in sorted(module.name for module in iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")

# By key in a scene file and in a scene, in the order of both.
LISTS: Mapping[str, type[ElementTable]] = MappingProxyType(
    {table.key: table for table in sorted(ElementTable.__subclasses__(), key=lambda table: (table.rank, table.key))}
)
TYPES = tuple(kind for table in LISTS.values() for kind in table.kinds)


def kinds_of(types: Iterable[type]) -> frozenset[str]:
    """The kinds of elements of some types, as of those in a model's registries; other types have none."""
    return frozenset(kind.kind for kind in types if issubclass(kind, Element))


PLAIN_KINDS = kinds_of(kind for kind in TYPES if kind.plain)  # of an engine that does not tell its own
ALL_KINDS = kinds_of(TYPES) | DRIVES
