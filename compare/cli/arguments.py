"""The arguments of the main job."""

import argparse
import sys
from argparse import ArgumentTypeError
from collections.abc import Sequence
from fnmatch import fnmatchcase
from functools import partial
from numbers import Integral
from pathlib import Path

from scenes import InputError, Sampling, Scene, limits
from scenes.arguments import names, refuse
from scenes.channels import Role
from scenes.errors import nearest, one_line
from scenes.model.motion import FEWEST

from ..engines import registry
from ..engines.registry import TIERS, Accuracy
from ..measure.many.grid import variation
from .command import Parser, called

USAGE = (
    " [SCENE ...] [--engines a,b] [--samples N] [--turns N] [--out DIR]"
    " [--channels LIST] [--accuracy A] [--full | --no-speed] [--check] [--open]"
    " [--vary PATH=FROM:TO:COUNT ... [--workers N | --scheduler ADDRESS]]"
    " [--monte-carlo N [--seed K] | --assemblies] [--format github] [--baseline FILE | --against OLD]"
    " [--result NAME=FILE.csv ...]; or list, new NAME, map [SCENE] NAME=FILE.csv, version"
)

COMMANDS = {
    "list": "scenes and engines, and what is missing to run them",
    "new NAME": "write NAME.toml, a commented scene to change",
    "map [SCENE] NAME=FILE.csv": "print a mapping that fits the columns of another program's result",
    "version": "of this program; `list` has those of the engines",
}

MAX_MACHINES = 1_000_000  # of a scene: their numbers take 200 MB


def parser() -> argparse.ArgumentParser:
    """The parser of a run; bad arguments raise InputError."""
    parser = Parser(
        prog=called(),
        usage=called() + USAGE,
        description="Solve planar linkages by independent models.",
        epilog=f"Other commands: {'; '.join(f'{name}, {about}' for name, about in COMMANDS.items())}.",
    )
    add = parser.add_argument
    add("scenes", nargs="*", metavar="SCENE", default=["toggle_press"], help="shipped name, or .toml file")
    add("--engines", type=_engines, default=",".join(registry.DEFAULT_ENGINES), help="comma-separated")
    add("--samples", type=partial(_count, FEWEST, 100_000), default=360, help="samples per cycle of the drive (360)")
    add("--turns", type=partial(_count, 1, 10_000), default=1, help="cycles of the drive (1)")
    parser.add_out("the reports")
    add("--channels", type=_names, help="only these, comma-separated; P5.* is all of P5 (all)")
    levels = f"{', '.join(TIERS)}, or the cheapest within a relative error as 1e-4 (balanced)"
    add("--accuracy", type=accuracy, help=f"the engines' settings: {levels}")
    about = "run a family instead, over a number of the scene file; may be given several times, for all combinations"
    many = parser.add_mutually_exclusive_group().add_argument  # each has linkages of its own
    many("--vary", type=variation, action="append", default=[], metavar="PATH=FROM:TO:COUNT", help=about)
    where = parser.add_mutually_exclusive_group().add_argument
    where("--workers", type=partial(_count, 1, 256), metavar="N", help="run the family by N processes")
    where("--scheduler", metavar="ADDRESS", help="run the family on the Dask cluster with this scheduler")
    about = "draw so many machines from the scene's [[variations]] instead, and report what the tolerances do"
    many("--monte-carlo", type=partial(_count, 2, MAX_MACHINES), metavar="N", help=about)
    many("--assemblies", action="store_true", help="draw all ways to put the bodies together instead, with circuits")
    add("--seed", type=partial(_count, 0, 2**32 - 1), metavar="K", help="of these draws (0)")
    about = "judge a result of another program too, by the mapping in FILE.toml or in the scene's [results.NAME]"
    add("--result", action="append", default=[], metavar="NAME=FILE.csv", help=about)
    table = parser.add_mutually_exclusive_group().add_argument
    table("--full", action="store_true", help="take more settings of each engine, timed for longer")
    table("--no-speed", action="store_true", help="leave the table of speed against error out")
    add("--check", action="store_true", help="exit 1 if a tolerance of a scene is missed")
    about = "of --check: annotations and a step summary too"
    add("--format", choices=("plain", "github"), default="plain", help=about)
    about = "name what changed since the run that wrote this summary.json"
    earlier = parser.add_mutually_exclusive_group().add_argument
    earlier("--baseline", type=Path, metavar="FILE", help=about)
    earlier("--against", type=Path, metavar="OLD", help="the same, and draw that run beside this one in the report")
    parser.set_defaults(since=0.0)  # s of processor time, at which the speed table before ended
    add("--open", action="store_true", help="open each report in the browser when it is written")
    return parser


def _names(text: str) -> list[str]:
    return list(dict.fromkeys(name.strip() for name in text.split(",")))


def _engines(text: str) -> list[str]:
    names = _names(text)
    registry.check_names(names)
    return names


def _count(least: int, most: int, text: str) -> int:
    if not (text.isdecimal() and len(text) < 20 and least <= int(text) <= most):
        raise ArgumentTypeError(f"expected a whole number from {least} to {most}, found '{one_line(text, 40)}'")
    return int(text)


def accuracy(text: str) -> Accuracy:
    """The accuracy that an argument asks for, or raise ArgumentTypeError."""
    if text in TIERS:
        return text
    try:
        level = float(text)
    except ValueError:
        level = 0.0
    if not 0 < level < 1:
        found = f"'{one_line(text, 40)}'{nearest(text, TIERS, or_all=False)}"
        raise ArgumentTypeError(f"expected {', '.join(TIERS)} or a relative error such as 1e-4, found {found}")
    return level


def from_python(engines: object, **others: object) -> argparse.Namespace:
    """Arguments of a Python function, by the names of their options, as options; bad ones raise InputError."""
    for name in others.keys() & {"samples", "turns"}:
        value = others[name]
        if isinstance(value, bool) or not isinstance(value, Integral) or abs(int(value)) > sys.maxsize:
            refuse(name, "a whole number", value)
    words = {"engines": ",".join(names("engines", engines)), **others}
    python = parser()
    python.usage = None
    return python.parse_args([f"--{name}={word}" for name, word in words.items()])


def sampling(scene: Scene, samples: int, turns: int, patterns: Sequence[str] | None = None) -> Sampling:
    """The sampling of a scene, for the channels that match one of the patterns, or all; bad ones raise InputError."""
    if turns > 1 and not scene.periodic:
        raise InputError(f"arguments: --turns {turns}: expected 1, since {scene.name} runs once from start to end")
    request = Sampling(samples, turns, channels=None if patterns is None else matching(scene, patterns))
    width = len(request.wanted(scene))
    if request.count * width > limits.VALUES:
        expected = f"--samples {samples} --turns {turns}: expected {limits.VALUES} values at most"
        found = f"{request.count} samples of {width} channels of {scene.name}"
        raise InputError(f"arguments: {expected}, found {found}; --channels asks for fewer")
    return request


def matching(scene: Scene, patterns: Sequence[str]) -> frozenset[str]:
    """The channels of a scene whose names match a pattern, as `P5.*`; InputError for one that matches none."""
    known = scene.channels.names(Role.kinematic, Role.force, Role.friction)
    for pattern in patterns:
        if not any(fnmatchcase(channel, pattern) for channel in known):
            raise InputError(f"--channels: {scene.name} has no channel '{pattern}'{nearest(pattern, known)}")
    return frozenset(c for c in known if any(fnmatchcase(c, pattern) for pattern in patterns))
