"""The study's files: the page, one row a point, and everything for a program."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from compare.engines.installed import environment
from compare.report.output.placing import placed
from compare.report.pages.html import render
from compare.report.plain import json_text

from ..constraints import ALONE, BOTH, LITERAL, slacks
from ..formulas import DEGREE, PUBLISHED, SCHEME_4, Design
from . import tables
from .figures import coordination, over_stroke
from .recheck import Recheck
from .study import AHEAD, ASSUMPTIONS, LENGTHS, MAIN, Point

FILES = ("design.html", "design.json", "design.csv")
CLEARANCES = {MAIN: BOTH, "sizes that allow scheme 4": ALONE}


@dataclass(frozen=True)
class DesignStudy:
    """All that a run finds."""

    points: Sequence[Point]
    rechecks: Sequence[Recheck]
    chosen: Mapping[str, Design]  # the designs ahead of scheme 4 that are drawn
    seconds: float  # that the optimisation took


def write(outcome: DesignStudy, folder: Path) -> Path:
    """Write `design.html`, `design.csv` and `design.json` into `folder/design/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    rows = tables.rows(outcome.points)
    with placed(folder, "design", FILES) as aside:
        pd.DataFrame(rows).to_csv(aside / "design.csv", index=False)
        (aside / "design.json").write_text(json_text(_all(outcome, rows)), encoding="utf-8")
        (aside / "design.html").write_text(page(outcome), encoding="utf-8")
    return folder / "design"


def page(outcome: DesignStudy) -> str:
    """The whole report as HTML."""
    points = outcome.points
    return render(
        "clamp/optimisation/design.html",
        "papers",
        tables=tables,
        outcome=outcome,
        points=points,
        findings=[*tables.findings(points), f"The optimisation took {outcome.seconds:.0f} s."],
        coordination=coordination(points, outcome.chosen),
        main=MAIN,
        lengths=LENGTHS,
        others=[name for name in ASSUMPTIONS if name != MAIN],
        over_stroke=over_stroke({"scheme 4": SCHEME_4} | dict(outcome.chosen)),
        literal=" and ".join(f"{-slacks(d, BOTH)[LITERAL] / DEGREE:.1f} deg ({name})" for name, d in PUBLISHED.items()),
        clearances=CLEARANCES,
    )


def _all(outcome: DesignStudy, rows: Sequence[Mapping[str, object]]) -> dict[str, Any]:
    count = len(PUBLISHED)
    return {
        "published": rows[:count],
        "clearances_mm": CLEARANCES,
        "points": [
            dict(row)
            | {"slack": {name: float(slack) for name, slack in slacks(p.optimum.design, p.problem.clearance).items()}}
            | {"waived": p.problem.waived, "limits": p.problem.limits, "short": p.short}
            for row, p in zip(rows[count:], outcome.points, strict=True)
        ],
        "ahead": [point.at for point in tables.of(outcome.points, AHEAD)],
        "rechecks": outcome.rechecks,
        "seconds": outcome.seconds,
        "environment": environment(),
    }
