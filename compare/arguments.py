"""The arguments of `python -m compare.run`."""

import argparse
from collections.abc import Callable
from pathlib import Path

from .asked import TIERS, accuracy
from .command_line import Parser
from .engines import registry
from .family.grid import variation

USAGE = (
    "python -m compare.run [SCENE ...] [--engines a,b] [--samples N] [--turns N] [--out DIR]"
    " [--channels LIST] [--accuracy A] [--vary PATH=FROM:TO:COUNT ...] [--full] [--check] [--list] [--new NAME]"
)


def parser() -> argparse.ArgumentParser:
    """Return what parses them; bad ones raise InputError."""
    parser = Parser(
        prog="python -m compare.run", usage=USAGE, description="Solve planar linkages by independent models."
    )
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", default=["toggle_press"], help="shipped name, or .toml file"
    )
    parser.add_argument("--engines", type=_engines, default=",".join(registry.DEFAULT_ENGINES), help="comma-separated")
    parser.add_argument("--samples", type=_count(8, 100_000), default=360, help="samples a cycle of the drive (360)")
    parser.add_argument("--turns", type=_count(1, 10_000), default=1, help="cycles of the drive (1)")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder for the reports (results)")
    parser.add_argument("--channels", type=_names, help="only these, comma-separated; P5.* is all of P5 (all)")
    parser.add_argument(
        "--accuracy",
        type=accuracy,
        help=f"the engines' settings: {', '.join(TIERS)}, or the cheapest within a relative error as 1e-4 (balanced)",
    )
    parser.add_argument(
        "--vary",
        type=variation,
        action="append",
        default=[],
        metavar="PATH=FROM:TO:COUNT",
        help="run a family instead, over a number of the scene file; may be given several times, for all combinations",
    )
    parser.add_argument("--full", action="store_true", help="take the long ladders, and time them for longer")
    parser.add_argument("--check", action="store_true", help="exit 1 if a tolerance of a scene is missed")
    parser.add_argument("--list", action="store_true", help="list scenes and engines, and what is missing to run them")
    parser.add_argument("--new", type=Path, metavar="NAME", help="write NAME.toml, a commented scene to change")
    return parser


def _names(text: str) -> list[str]:
    return list(dict.fromkeys(name.strip() for name in text.split(",")))


def _engines(text: str) -> list[str]:
    names = _names(text)
    registry.check_names(names)
    return names


def _count(least: int, most: int) -> Callable[[str], int]:
    def parse(text: str) -> int:
        if not (text.isdecimal() and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"expected a whole number from {least} to {most}, found '{text}'")
        return int(text)

    return parse
