"""Remake `results/published/formulations.md`: the optional engines on shipped, hard and random scenes, and their speed.

Needs `pip install -e '.[casadi,mujoco,pinocchio,publish]'`. Times are of the processor, the least of several solves.
Hard and random scenes take an hour of one core; a run that was stopped goes on with them.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

import scenes
from benchmarks import promises
from compare.engines import registry
from compare.engines.runner import run
from compare.judge.measure import measure
from compare.measure.hard.case import forget, hard_cases
from compare.mechanics.reference import Reference, uncertified
from compare.report.tables.hard import counts, verdict
from scenes import Sampling, Settings
from scenes.hard import catalogue

ENGINES = ("casadi", "pinocchio", "mujoco")
RESULTS = Path(__file__).parents[2] / "results"
FILE, RANDOM = RESULTS / "published" / "formulations.md", RESULTS / "promises_of_formulations.csv"
SAMPLING, REPEATS = Sampling(360), 3
LADDER = Sampling(72)
GROUPS = ("position", "velocity", "acceleration", "reaction", "torque", "force")


def main() -> None:
    """Measure and write."""
    references = {name: uncertified(scenes.load(name)) for name in scenes.shipped()}
    shipped = [
        row(reference, engine, registry.engine(engine).DEFAULT, SAMPLING)
        for engine in ENGINES
        for reference in references.values()
    ]
    press = references["toggle_press"]
    ladders = [
        row(press, engine, settings, LADDER)
        for engine in ENGINES
        for settings in registry.engine(engine).WORK_PRECISION
    ]
    hard = hard_cases(catalogue(), ENGINES, RESULTS, print, print)
    with TemporaryDirectory() as folder:
        random = promises.judged(promises.study(Path(folder), promises.SCENES, ENGINES, RANDOM))
    massless = random[random["features"].str.contains("massless")]["number"].nunique()
    text = [
        "# The optional engines",
        "Made by `python -m benchmarks.publishing.formulations`. Largest relative errors against the analytic core by"
        " group, and the processor time of the solve by position: beside other work on the machine, so"
        " that ratios count.",
        f"## Every shipped scene, {SAMPLING.samples} samples, default settings",
        pd.DataFrame(shipped).drop(columns="setting").to_markdown(index=False),
        f"## Speed against error: the toggle press, {LADDER.samples} samples",
        pd.DataFrame(ladders).drop(columns=["scene", "force"]).to_markdown(index=False),
        "## Hard cases, each series to its last step",
        f"{verdict(hard)} MuJoCo makes a second attempt at its finest setting where the first one fails.",
        pd.DataFrame(counts(hard)).to_markdown(index=False),
        "## Random scenes, at all accuracies",
        f"{len(random)} runs at {', '.join(map(str, promises.SAMPLES))} samples. A broken promise is a run that is ok"
        " and wrong, a false alarm one that was refused by a check and is within what was asked for."
        f" {massless} of the scenes have bodies without mass, which MuJoCo refuses.",
        promises.by_accuracy(random).reset_index().to_markdown(index=False, floatfmt=".1e"),
    ]
    forget(RESULTS)
    FILE.write_text("\n\n".join(text) + "\n", encoding="utf-8")


def row(reference: Reference, engine: str, settings: Settings, sampling: Sampling) -> dict[str, str]:
    """Return the row of one engine on one scene at one setting."""
    measured = measure(reference, engine, sampling, settings)
    solves = [run(engine, reference.scene, sampling, settings).solve_s for _ in range(REPEATS)]  # NaN of a refusal
    worst = measured.worst()
    return {
        "engine": engine,
        "scene": reference.scene.name,
        "setting": settings.label,
        "status": measured.run.status.name,
        **{group: f"{worst[group]:.1e}" if group in worst else "" for group in GROUPS},
        "us a position": f"{1e6 * min(solves) / sampling.count:.0f}",
        "refused because": measured.run.reason,
    }


if __name__ == "__main__":
    main()
