"""Remake `results/published/`, the summary and pictures that the README shows, and the README's own tables.

Needs `pip install -e '.[publish]'`.
"""

from pathlib import Path

import pandas as pd

import compare
import scenes
from benchmarks.publishing import readme
from benchmarks.publishing.first_screen import FILE, first_screen
from compare.engines.kept import environment
from compare.engines.registry import DEFAULT_ENGINES
from compare.measure.hard.case import forget, hard_cases
from compare.measure.speed.speed_table import Budget
from compare.report.figures.curves import over_angle, panels
from compare.report.figures.offline import offline
from compare.report.figures.speed import work_precision
from compare.report.tables.hard import counts, verdict
from compare.report.tables.study import by_group, checks, notes, overview, setup
from compare.study import study
from scenes.hard import catalogue

FOLDER = Path(__file__).parents[2] / "results" / "published"
PICTURED = "P5: acceleration"


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
    shown = readme.tables(result, hard)
    readme.fill(shown)
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


if __name__ == "__main__":
    main()
