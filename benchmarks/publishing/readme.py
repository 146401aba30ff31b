"""The tables of figures in README and docs/, from `<!-- name -->` to `<!-- end -->`; see tests/test_readme.py."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from compare.engines.registry import REFERENCE
from compare.judge.errors import shown_groups
from compare.measure.speed.work_precision import SpeedRow, choices
from compare.report.tables.hard import counts
from compare.report.tables.speed import contender
from compare.report.tables.study import overview
from compare.study import Study

ROOT = Path(__file__).parents[2]
README, FINDINGS = ROOT / "README.md", ROOT / "docs" / "findings.md"
PAGES = {"errors": README, "times": FINDINGS, "hard": FINDINGS}  # where each table stands
LEVELS = ("1 %", "0.1 %", "1e-4", "1e-6")  # of the joint reactions
OUTCOMES = ["engine", "attempts", "right", "refused", "silent", "false alarm"]


def tables(study: Study, hard: pd.DataFrame) -> dict[str, str]:
    """Return the tables by name, as Markdown."""
    return {
        "errors": errors(study),
        "times": times(study.speed),
        "hard": markdown(pd.DataFrame(counts(hard))[OUTCOMES]),
    }


def errors(study: Study) -> str:
    """Return the largest error of every engine by channel group, to two digits."""
    groups = pd.DataFrame(overview(study)).set_index("engine")[list(shown_groups(study.scene))]
    return markdown(groups.drop(REFERENCE).map(lambda error: f"{error:.1e}").reset_index())


def times(speed: Sequence[SpeedRow]) -> str:
    """Return the time of the cheapest setting for errors of the reactions, a row for every contender but the reference.

    Where two engines are level, both are marked.
    """
    rows: dict[str, dict[str, str]] = {}
    for choice in choices(speed):
        if choice.group == "reaction" and choice.engine != REFERENCE and choice.level in LEVELS:
            name = contender(choice.engine, choice.note)
            level = " (level)" if choice.standing == "level" else ""
            text = f"{1e3 * choice.solve_s:.3g} ms{level}" if choice.setting else "never"
            rows.setdefault(name, {"engine": name})[choice.level] = text
    return markdown(pd.DataFrame(rows.values()))


def markdown(table: pd.DataFrame) -> str:
    """Return a table as Markdown."""
    lines = [table.columns, ["---"] * len(table.columns), *table.to_numpy(str)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def fill(found: dict[str, str]) -> None:
    """Put the tables into their pages, in place of those there."""
    for name, table in found.items():
        before, rest = PAGES[name].read_text(encoding="utf-8").split(f"<!-- {name} -->\n\n")
        _, after = rest.split("\n\n<!-- end -->", maxsplit=1)
        PAGES[name].write_text(f"{before}<!-- {name} -->\n\n{table}\n\n<!-- end -->{after}", encoding="utf-8")
