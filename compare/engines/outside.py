"""Where engines live; those of other distributions by entry points of the group `linkage_crosscheck.engines`.

An entry point names a module: `mine = "my_package.engine"`. Only metadata are read before an engine is asked for.
An engine whose name another has as well is called NAME@DISTRIBUTION.
"""

import pickle
import re
import sys
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, make_dataclass, replace
from functools import cache, cached_property
from importlib import import_module
from importlib.util import find_spec
from itertools import chain
from multiprocessing import current_process
from operator import attrgetter
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NoReturn, TypeAlias, get_type_hints

from scenes import Engine, Settings, Status
from scenes.errors import one_line
from scenes.fields import ENGINE
from scenes.model.engine import completed

from .installed import may_offer, version
from .processes.inside import PLAIN, Ended, Limits, packed
from .processes.isolation import isolated
from .reasons import described, text_of

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "linkage_crosscheck.engines"
LIMITS = Limits(20.0)  # of an import
TIERS, LADDERS = ("DEFAULT", "FAST", "EXACT"), ("WORK_PRECISION", "LONG_WORK_PRECISION", "ABLATIONS")
FUNCTIONS = ("build", "at_steps", "iterations_needed")
Meanings: TypeAlias = tuple[tuple[str, str], ...]  # by name of a field
Told: TypeAlias = tuple[str, Iterable[tuple[str, str]], Mapping[str, object]]  # of settings; see `told`


@dataclass(frozen=True)
class Entry:
    """Where an engine lives and what must be installed for it."""

    purpose: str
    module: str
    package: str  # what is imported
    distribution: str  # what is installed
    install: str
    outside: str = ""  # name and version of the distribution that offers it, where that is not this project
    trouble: str = ""  # what keeps it from running, whatever is installed

    @property
    def missing(self) -> str | None:
        """The step to take before the engine can run, or None when it can."""
        if self.trouble:
            return self.trouble
        return None if find_spec(self.package) else f"{self.distribution} is not installed: {self.install}"

    @cached_property
    def version(self) -> str:
        """Return the installed version of what does the work, without importing it."""
        with suppress(ImportError):  # of which one that is not found is a kind
            return self.outside or f"{self.distribution} {version(self.distribution)}"
        return "not installed"


# Distributions are scanned by their metadata alone; no code of theirs is imported. Names are compared without case, as
# files and options are; where several engines share a name all of them carry their distribution's.
def entries(taken: Collection[str]) -> dict[str, Entry]:
    """Return the entries of all engines that installed distributions offer, by name; others have those `taken`."""
    if not may_offer(GROUP):
        return {}
    from importlib.metadata import EntryPoint, distributions  # late, as few have any

    first: dict[str, tuple[EntryPoint, ...]] = {}  # of one that is found twice; of a broken one there is none
    for each in distributions():
        with suppress(Exception):  # of anybody's files: not UTF-8, or a line that is no entry point
            if points := tuple(each.entry_points.select(group=GROUP)):
                first.setdefault(each.name, points)
    known = [(point.name, _entry(point)) for point in sorted(chain(*first.values()), key=attrgetter("name"))]
    count = Counter(name.lower() for name in (*taken, *(name for name, _ in known)))  # no two differ by case alone
    return {name if count[name.lower()] == 1 else f"{name}@{entry.distribution}": entry for name, entry in known}


def _entry(point: "EntryPoint") -> Entry:
    from importlib.metadata import Distribution  # late, as above

    assert point.dist is not None
    known = {key: one_line(point.dist.metadata[key], 80) for key in point.dist.metadata}
    name, module = known.get("Name", "a nameless distribution"), point.value.strip()
    package = module.partition(".")[0]
    needs = [need[0] for each in point.dist.requires or () if ";" not in each and (need := re.match(r"[\w.-]+", each))]
    lacking = next((need for need in needs if not any(Distribution.discover(name=need))), "")
    trouble = ""
    if not re.fullmatch(ENGINE, point.name):
        trouble = "its name is expected to be letters, digits, '_', '.' and '-', 40 at most"
    elif not re.fullmatch(ENGINE, name):
        trouble = "its distribution's name is expected to be letters, digits, '_', '.' and '-', 40 at most"
    elif not all(part.isidentifier() for part in module.split(".")):
        trouble = f"its entry point is expected to name a module, found {module}"
    elif lacking:
        trouble = f"it needs {lacking}, which is not installed: pip install {name}"
    elif package == "__main__" or not find_spec(package):
        trouble = f"{name} lacks its module {package}: pip install {name}"
    version, purpose = f"{name} {known.get('Version', '')}".strip(), known.get("Summary") or f"an engine of {name}"
    return Entry(purpose, module, package, name, f"pip install {name}", outside=version, trouble=one_line(trouble))


@cache
def imported(entry: Entry) -> Engine[Any]:
    """Return an engine, imported in this process, or raise what keeps it from being one."""
    engine = completed(import_module(entry.module), entry.version)
    check(engine)
    return engine


# Code of strangers may crash, hang or print: an engine from outside is imported in a process with limits, and only what
# it offers (names, labels, plain values) comes back. Settings are represented here by `StandIn`, with a pickle that is
# opened in the engine's own process alone.
def offered(entry: Entry) -> tuple[Engine[Any], Ended | None]:
    """An engine's offer, and how its import ended where that is nothing.

    Unless it is already in this process, it is imported in one of its own, and none of its functions can be called.
    """
    if entry.module in sys.modules or current_process().daemon:  # which may have no processes
        try:
            return imported(entry), None
        except Exception as error:
            offers: Mapping[str, Any] | Ended = Ended(Status.crashed, described(error))
    else:
        offers = _offers(entry)
    if isinstance(offers, Ended):
        return completed(SimpleNamespace(DEFAULT=Settings("default"), build=_elsewhere), entry.version), offers
    return completed(SimpleNamespace(**offers), entry.version), None


@cache
def _offers(entry: Entry) -> Mapping[str, Any] | Ended:
    ((_, offers),) = isolated(_described, [entry], LIMITS, lambda: None, PLAIN)
    if isinstance(offers, Ended):
        return offers
    try:
        tiers = {name: stood_in(offers["tiers"][name]) for name in TIERS}
        ladders = {name: tuple(map(stood_in, offers["ladders"][name])) for name in LADDERS}
        check_labels((*tiers.values(), *chain(*ladders.values())))
    except Exception as error:  # whatever an engine has sent in the place of an answer
        return Ended(Status.crashed, f"its settings cannot be read: {described(error)}")
    return tiers | ladders | {name: _elsewhere for name in FUNCTIONS if name in offers["functions"]}


def _described(entry: Entry) -> Mapping[str, Any]:
    engine = imported(entry)
    return {
        "tiers": {name: told(getattr(engine, name)) for name in TIERS},
        "ladders": {name: [*map(told, getattr(engine, name))] for name in LADDERS},
        "functions": [name for name in FUNCTIONS if getattr(engine, name) is not None],
    }


def _elsewhere(*_: object) -> NoReturn:
    raise ImportError("the engine is not imported in this process")


def check(engine: Engine[Any]) -> None:
    """Raise TypeError or ValueError for an engine whose settings are not what the protocol asks for."""
    settings = [getattr(engine, name) for name in TIERS]
    for ladder in (getattr(engine, name) for name in LADDERS):
        if not isinstance(ladder, tuple):
            raise TypeError(f"expected a tuple of settings, found {type(ladder).__name__}")
        settings += ladder
    if engine.at_steps:
        check_settings(engine.at_steps(24))
    check_labels(settings)


def check_labels(settings: Collection[Settings]) -> None:
    """Raise TypeError or ValueError for settings that are none, or of which two have one label."""
    for each in settings:
        check_settings(each)
    ((label, number),) = Counter(each.label for each in dict.fromkeys(settings)).most_common(1)
    if number > 1:
        raise ValueError(f"expected a label of its own for each of its settings, found two of {label}")


def check_settings(settings: object) -> None:
    """Raise TypeError for what an engine offers as settings and nothing else could take for them."""
    if not isinstance(settings, Settings):
        raise TypeError(f"expected scenes.Settings, found {type(settings).__name__}")
    if not (isinstance(settings.label, str) and settings.label == one_line(settings.label, 60) != ""):
        raise TypeError(f"expected a label of one line, 60 characters at most, found {settings.label!r}")
    if not isinstance(steps := getattr(settings, "steps", None), int | None):
        raise TypeError(f"{settings.label}: expected steps that are a whole number, found {steps!r}")
    ordered = settings.order is None or (isinstance(settings.order, float | int) and settings.order > 0)
    if not (ordered and {str} == {type(settings.family), type(settings.note)}):
        raise TypeError(f"{settings.label}: expected an order above zero or None, and family and note as text")
    for promise in (settings.promise, settings.drive_promise):
        if not (isinstance(promise, float) and 0 < promise < 1):
            raise TypeError(f"{settings.label}: expected a promise between 0 and 1, found {promise!r}")


class StandIn(Settings):
    """Settings of plain values, with the names and meanings of an engine's own, where that is not imported."""

    as_sent: ClassVar[bytes]  # the engine's own, pickled: to be read where the engine is imported alone
    meanings: ClassVar[Meanings]

    def __reduce__(self) -> tuple[object, ...]:
        return standing, (self.as_sent, self.meanings, vars(self))


def told(settings: Settings) -> Told:
    """An engine's settings as plain data: their pickle in hex, and the meanings and plain values of their fields."""
    hints: Mapping[str, Any] = {}
    with suppress(Exception):  # annotations may be of anything
        hints = get_type_hints(type(settings), include_extras=True)
    names = [field.name for field in fields(settings)]
    meanings = tuple((name, text_of(getattr(hints.get(name), "__metadata__", ("",))[0])) for name in names)
    return packed(settings).hex(), meanings, {name: _plain(getattr(settings, name)) for name in names}


def stood_in(told: Told) -> Settings:
    """Stand-in settings from the plain data of `told`, or raise whatever is wrong with it."""
    as_sent, meanings, values = told
    known = tuple((name, text_of(meaning)) for name, meaning in meanings)
    if [*values] != [name for name, _ in known] or any(name.startswith("_") for name in values):
        raise ValueError("expected fields with a meaning and a value each")
    stands = standing(bytes.fromhex(as_sent), known, {name: _plain(value) for name, value in values.items()})
    check_settings(stands)
    return stands


def stand_in(settings: Settings) -> Settings:
    """Settings of plain values in place of an engine's own."""
    return settings if isinstance(settings, StandIn) else stood_in(told(settings))


def _plain(value: Any) -> object:
    kind = next((kind for kind in (bool, int, float) if isinstance(value, kind)), text_of)
    return None if value is None else kind(value)


def standing(as_sent: bytes, meanings: Meanings, values: Mapping[str, Any]) -> Settings:
    """Settings in place of others, by these as they are sent, and the meanings and values of their fields."""
    return _kind(as_sent, meanings)(**values)


@cache
def _kind(as_sent: bytes, meanings: Meanings) -> type[Settings]:
    known = {field.name for field in fields(Settings)}
    more = [(name, Annotated[Any, meaning]) for name, meaning in meanings if name not in known]
    namespace = {"as_sent": as_sent, "meanings": meanings}
    return make_dataclass("StandIn", more, bases=(StandIn,), namespace=namespace, frozen=True, kw_only=True)


def unpacked(settings: Settings) -> Settings:
    """Return the engine's own settings, where these stand in for them and the engine is imported."""
    if not isinstance(settings, StandIn):
        return settings
    received: Settings = pickle.loads(settings.as_sent)
    return replace(received, promise=settings.promise)
