"""`python -m papers.optimise`: the clamp's optimisation, from nothing to the report."""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from compare.report.files import check_writable
from scenes import InputError

from .clamp.formulas import Array
from .clamp.optimisation import tables
from .clamp.optimisation.recheck import ENGINES, Recheck, rechecks
from .clamp.optimisation.report import Outcome, write
from .clamp.optimisation.study import AHEAD, AS_PRINTED, MAIN, MET, RATIOS, SIX, THREE, Effort, Point, study


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, 1 for a point that is no optimum, 2 for bad input."""
    parser = argparse.ArgumentParser(prog="python -m papers.optimise", description="Optimise the double-toggle clamp.")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder for the report (results)")
    options = parser.parse_args(arguments)
    try:
        check_writable(options.out)
        return _run(options.out)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; nothing was written", file=sys.stderr)
        return 130


def _run(folder: Path) -> int:
    started = perf_counter()
    points = optimised(Effort(), RATIOS)
    seconds = perf_counter() - started
    chosen = chosen_from(points)
    outcome = Outcome(points, _rechecked(chosen, points), chosen, seconds)
    page = write(outcome, folder) / "design.html"
    for sentence in tables.verdicts(points):
        print(sentence)
    for point in tables.improved(points):
        print(f"no optimum: {point.set}, {point.at}")
    print(f"report: {page}")
    return 1 if tables.improved(points) else 0


def optimised(effort: Effort, ratios: Sequence[float]) -> list[Point]:
    """Return the study's points, its progress shown."""
    columns = (TextColumn("{task.description}"), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("optimising")

        def advance(point: Point, total: int) -> None:
            progress.update(task, advance=1, total=total, description=f"{point.set}: {point.at}")

        return study(effort, ratios, advance)


def chosen_from(points: Sequence[Point]) -> Mapping[str, Array]:
    """Return the designs put forward: ahead of scheme 4 under the strictest conditions that allow one, at each aim."""
    wanted = {
        "ahead_in_three": f"{THREE}; {AS_PRINTED}; sizes for both",
        "ahead_in_six": f"{SIX}; {MET}; sizes for scheme 4",
    }
    found = {point.at: point.optimum.X for point in tables.of(points, AHEAD)}
    return {name: found[at] for name, at in wanted.items() if at in found}


def _rechecked(chosen: Mapping[str, Array], points: Sequence[Point]) -> list[Recheck]:
    curve = {point.at: point.optimum.X for point in tables.of(points, MAIN)}
    with Console(stderr=True).status("") as status:
        designs = dict(chosen) | {"curve_at_1_10": curve["R_S = 1.10"]}
        return list(rechecks(designs, ENGINES, lambda doing: status.update(f"checking {doing}")))


if __name__ == "__main__":
    sys.exit(main())
