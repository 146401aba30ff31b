"""`python -m compare.run`: from scene names to reports."""

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from rich.console import Console

from scenes import InputError, Sampling, Scene, load, shipped, write_starter

from . import registry

if TYPE_CHECKING:
    from .study import Study

USAGE = (
    "python -m compare.run [SCENE ...] [--engines a,b] [--samples N] [--turns N] [--out DIR]"
    " [--full] [--check] [--list] [--new NAME]"
)


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, 1 for a missed tolerance, 2 for bad input."""
    try:
        options = _parser().parse_args(arguments)
        if options.list:
            return _list()
        if options.new:
            print("wrote", " and ".join(map(str, write_starter(options.new))))
            return 0
        return _run(options)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except BrokenPipeError:  # whoever read the output has seen enough; what is still to be flushed goes nowhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print("stopped; nothing was written for the scene under way", file=sys.stderr)
        return 130


class _Parser(argparse.ArgumentParser):
    """Bad arguments are told in one line, like all bad input."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"arguments: {message}; usage: {USAGE}")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="python -m compare.run", usage=USAGE, description="Solve planar linkages by independent models."
    )
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", default=["toggle_press"], help="shipped name, or .toml file"
    )
    parser.add_argument("--engines", type=_engines, default=",".join(registry.DEFAULT_ENGINES), help="comma-separated")
    parser.add_argument("--samples", type=_count(8, 100_000), default=360, help="samples a turn (360)")
    parser.add_argument("--turns", type=_count(1, 10_000), default=1, help="turns of the crank (1)")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder for the reports (results)")
    parser.add_argument("--full", action="store_true", help="take the long ladders, and time them for longer")
    parser.add_argument("--check", action="store_true", help="exit 1 if a tolerance of a scene is missed")
    parser.add_argument("--list", action="store_true", help="list scenes and engines, and what is missing to run them")
    parser.add_argument("--new", type=Path, metavar="NAME", help="write NAME.toml, a commented scene to change")
    return parser


def _engines(text: str) -> list[str]:
    names = list(dict.fromkeys(name.strip() for name in text.split(",")))
    registry.check_names(names)
    return names


def _count(least: int, most: int) -> Callable[[str], int]:
    def parse(text: str) -> int:
        if not (text.isdecimal() and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"expected a whole number from {least} to {most}, found '{text}'")
        return int(text)

    return parse


def _list() -> int:
    width = max(map(len, (*shipped(), *registry.ENTRIES)))
    for name in shipped():
        print(f"scene   {name:{width}}  {load(name).title}")
    for name, entry in registry.ENTRIES.items():
        print(f"engine  {name:{width}}  {entry.purpose} ({entry.missing or entry.version})")
    return 0


def _run(options: argparse.Namespace) -> int:
    scenes = [load(name) for name in options.scenes]
    names = [scene.name for scene in scenes]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"arguments: two scenes are named '{name}', and both would write {options.out / name}")

    from . import output  # late: the tables and plots are slow to import, and bad input should be told at once
    from .speed import Budget
    from .study import study

    output.check_writable(options.out)
    budget = Budget(rounds=100, seconds=60.0, long_ladders=True) if options.full else Budget(rounds=10, seconds=1.0)
    missed = False
    for scene in scenes:
        with Console(stderr=True).status(scene.name) as status:  # says nothing when it is not a terminal

            def progress(doing: str, scene: Scene = scene) -> None:
                status.update(f"{scene.name}: {doing}")

            result = study(scene, options.engines, Sampling(options.samples, options.turns), budget, progress)
            progress("writing the report")
            folder = output.write(result, options.out)
        _tell(result)
        print(f"report: {folder / 'report.html'}")
        missed |= options.check and _missed(result)
    return 1 if missed else 0


def _tell(result: "Study") -> None:
    from .tables import SHOWN_GROUPS, overview

    for row in overview(result).to_dict("records"):
        errors = "  ".join(f"{group} {row[group]:.1e}" for group in SHOWN_GROUPS if row[group] == row[group])
        print(f"{result.scene.name}  {row['engine']:14} {row['status']:15} {errors}")
    for m in result.measurements:
        if m.run.reason:
            print(f"{result.scene.name}  {m.run.engine}: {m.run.reason}")


def _missed(result: "Study") -> bool:
    """Name every tolerance that was missed."""
    if not result.gates:
        print(f"{result.scene.name}  no tolerance is declared for these engines")
    for gate in result.gates:
        if gate.missed:
            print(f"{result.scene.name}  missed: {gate}")
    return any(gate.missed for gate in result.gates)


if __name__ == "__main__":
    sys.exit(main())
