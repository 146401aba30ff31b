"""The study's files: the page, one row a point, and everything for a program."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from html import escape
from math import isfinite
from pathlib import Path
from typing import Any

import pandas as pd

from compare.engines.environment import environment
from compare.report.files import placed
from compare.report.html import figure_html, head, table_html, template

from ..constraints import slacks
from ..formulas import SCHEME_4, Array
from . import tables
from .figures import coordination, over_stroke
from .recheck import Recheck
from .study import AHEAD, ALONE, ASSUMPTIONS, BOTH, LENGTHS, MAIN, Point


@dataclass(frozen=True)
class Outcome:
    """All that a run finds."""

    points: Sequence[Point]
    rechecks: Sequence[Recheck]
    chosen: Mapping[str, Array]  # the designs ahead of scheme 4 that are drawn
    seconds: float  # that the optimisation took


def write(outcome: Outcome, folder: Path) -> Path:
    """Write `design.html`, `design.csv` and `design.json` into `folder/design/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    rows = tables.rows(outcome.points)
    with placed(folder, "design", "design.*") as aside:
        pd.DataFrame(rows).to_csv(aside / "design.csv", index=False)
        text = json.dumps(_plain(_all(outcome, rows)), indent=1, allow_nan=False)
        (aside / "design.json").write_text(text + "\n", encoding="utf-8")
        (aside / "design.html").write_text(page(outcome), encoding="utf-8")
    return folder / "design"


def page(outcome: Outcome) -> str:
    """Return the whole report as HTML."""
    points = outcome.points
    others = (
        f"<h3>{escape(name)}</h3>{table_html(tables.curve(points, name))}" for name in ASSUMPTIONS if name != MAIN
    )
    literal = " and ".join(f"{-slack:.1f} deg ({name})" for name, slack in tables.literal_slack().items())
    said = [*tables.verdicts(points), f"The optimisation took {outcome.seconds:.0f} s."]
    return template("papers.clamp.optimisation", "design.html").substitute(
        head=head("Double-toggle clamp: its optimisation"),
        verdicts="".join(f"<li>{escape(sentence)}</li>" for sentence in said),
        curve_figure=figure_html(coordination(points, outcome.chosen)),
        curve=table_html(tables.curve(points, MAIN)),
        steps=table_html(tables.curve(points, LENGTHS)),
        others="".join(others),
        ahead=table_html(tables.ahead(points)),
        stroke_figure=figure_html(over_stroke({"scheme 4": SCHEME_4} | dict(outcome.chosen))),
        rechecks=table_html(tables.rechecked(outcome.rechecks)),
        published=table_html(tables.published()),
        literal=literal,
        assumed=table_html(tables.assumed({MAIN: BOTH, "sizes that allow scheme 4": ALONE})),
        constraints=table_html(tables.constraints(points)),
        environment=table_html(pd.DataFrame(environment().items(), columns=["of", "version"]), "text"),
    )


def _all(outcome: Outcome, rows: Sequence[Mapping[str, object]]) -> dict[str, Any]:
    described = rows[len(tables.PUBLISHED) :]
    return {
        "published": rows[: len(tables.PUBLISHED)],
        "clearances_mm": {MAIN: asdict(BOTH), "sizes that allow scheme 4": asdict(ALONE)},
        "points": [
            dict(row)
            | {"slack": {name: float(value) for name, value in slacks(p.optimum.X, p.problem.clearance).items()}}
            | {"waived": sorted(p.problem.waived), "limits": [asdict(limit) for limit in p.problem.limits]}
            | {"short": list(p.short)}
            for row, p in zip(described, outcome.points, strict=True)
        ],
        "ahead": [point.at for point in tables.of(outcome.points, AHEAD)],
        "rechecks": [asdict(recheck) for recheck in outcome.rechecks],
        "seconds": outcome.seconds,
        "environment": environment(),
    }


def _plain(value: Any) -> Any:
    """Return the value as JSON can hold it: what is not finite becomes null."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
