"""Remake `results/published/formulations.md`: the optional engines on every shipped scene, and their ladders.

Needs `pip install -e '.[casadi,mujoco,pinocchio,publish]'`. Times are of the processor, the least of several solves.
"""

from pathlib import Path

import pandas as pd

import scenes
from compare.engines import registry
from compare.engines.reference import Reference, found
from compare.engines.runner import run
from compare.judge.measure import measure
from scenes import Sampling, Settings

ENGINES = ("casadi", "pinocchio", "mujoco")
FILE = Path(__file__).parents[1] / "results" / "published" / "formulations.md"
SAMPLING, REPEATS = Sampling(360), 3
LADDER = Sampling(72)
GROUPS = ("position", "velocity", "acceleration", "reaction", "torque", "force")


def main() -> None:
    """Measure and write."""
    references = {name: found(scenes.load(name)) for name in scenes.shipped()}
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
    text = [
        "# The optional engines",
        "Made by `python benchmarks/formulations.py`. Largest relative errors against the analytic core by group, and"
        " the processor time of the solve by position: beside other work on the machine, so that ratios count.",
        f"## Every shipped scene, {SAMPLING.samples} samples, default settings",
        pd.DataFrame(shipped).drop(columns="setting").to_markdown(index=False),
        f"## Speed against error: the toggle press, {LADDER.samples} samples",
        pd.DataFrame(ladders).drop(columns=["scene", "force"]).to_markdown(index=False),
    ]
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
