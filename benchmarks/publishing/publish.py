"""Remake `results/published/`, the summary and pictures that the README shows, and the tables of README and docs/.

Needs `pip install -e '.[publish]'`. The tables stand from `<!-- name -->` to `<!-- end -->`; see tests/test_readme.py.
"""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

import compare
import scenes
from benchmarks.publishing.first_screen import FILE, first_screen
from benchmarks.publishing.reference import markdown
from compare.engines.kept import environment
from compare.engines.registry import DEFAULT_ENGINES, REFERENCE
from compare.judge.errors import shown_groups
from compare.measure.hard.case import forget, hard_cases
from compare.measure.speed.speed_table import Budget
from compare.measure.speed.work_precision import SpeedRow, choices
from compare.report.figures.curves import over_angle, panels
from compare.report.figures.offline import offline
from compare.report.figures.speed import work_precision
from compare.report.tables.hard import counts, verdict
from compare.report.tables.speed import contender
from compare.report.tables.study import by_group, checks, notes, overview, setup
from compare.study import Study, study
from scenes.hard import catalogue

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "results" / "published"
PICTURED = "P5: acceleration"
README, FINDINGS = ROOT / "README.md", ROOT / "docs" / "findings.md"
PAGES = {"errors": README, "times": FINDINGS, "hard": FINDINGS}  # where each table stands
LEVELS = ("1 %", "0.1 %", "1e-4", "1e-6")  # of the joint reactions
OUTCOMES = ["engine", "attempts", "right", "refused", "silent", "false alarm"]


def main() -> None:
    """Run the toggle press with all settings of every engine, and write tables and pictures."""
    scene = scenes.load("toggle_press")
    result = study(scene, DEFAULT_ENGINES, scenes.Sampling(360), Budget(100, 30.0, full=True), print)
    hard = hard_cases(catalogue(), DEFAULT_ENGINES, FOLDER, print, print)
    forget(FOLDER)
    FOLDER.mkdir(exist_ok=True)
    for panel in panels(result.reference, result.sampling):
        if panel.title == PICTURED:
            figure = over_angle(result, panel).update_layout(title={"text": panel.title, "y": 0.99}, margin={"t": 70})
            offline(figure).write_image(FOLDER / "acceleration.svg", width=760, height=500)
    offline(work_precision(result)).write_image(FOLDER / "speed.svg", width=1180, height=930)
    FILE.write_text(first_screen(compare.check(scene)), encoding="utf-8")
    speed = pd.DataFrame([row.cells for row in result.speed])[
        ["engine", "setting", "solve_min_s", "solve_median_s", "position_max", "reaction_max", "torque_max"]
    ]
    groups = pd.DataFrame(by_group(result)).drop(columns=["last_turn_max"])
    where = pd.DataFrame(environment().items(), columns=["environment", "version"])
    shown = {
        "errors": errors(result),
        "times": times(result.speed),
        "hard": markdown(pd.DataFrame(counts(hard))[OUTCOMES]),
    }
    fill(shown)
    text = [
        f"# {scene.title}: published summary",
        f"{setup(result)} Made by `python -m benchmarks.publishing.publish`. {notes(result)[0]}",
        *(_section(title, table) for title, table in (
            ("Engines at their default settings: largest relative errors", pd.DataFrame(overview(result))),
            ("Cheapest settings for an error of the joint reactions, 72 samples a turn", shown["times"]),
            ("Errors by group", groups),
            ("Checks without a reference", pd.DataFrame(checks(result))),
            ("Speed against error: one turn, 72 samples", speed),
            (f"Hard cases: {verdict(hard)}", pd.DataFrame(counts(hard))),
            ("Made on", where),
        )),
    ]  # fmt: skip
    (FOLDER / "README.md").write_text("\n\n".join(text) + "\n", encoding="utf-8")


def _section(title: str, table: pd.DataFrame | str) -> str:
    return f"## {title}\n\n{table if isinstance(table, str) else table.to_markdown(index=False, floatfmt='.3g')}"


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


def fill(found: dict[str, str]) -> None:
    """Put the tables into their pages, in place of those there."""
    for name, table in found.items():
        before, rest = PAGES[name].read_text(encoding="utf-8").split(f"<!-- {name} -->\n\n")
        _, after = rest.split("\n\n<!-- end -->", maxsplit=1)
        PAGES[name].write_text(f"{before}<!-- {name} -->\n\n{table}\n\n<!-- end -->{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
