"""The report on one scene."""

from argparse import Namespace
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from scenes import Sampling, Scene

from ..engines import registry
from .printing import print_result, show_page, stops

if TYPE_CHECKING:
    from ..ci.baseline import Change, Summary
    from ..study import Study


def run(scene: Scene, request: Sampling, options: Namespace, show: Callable[[str], None]) -> bool:
    """Write one scene's report, and return whether it misses a tolerance.

    Where the user stops, what was done till then is written, if there is a reference to report on.
    """
    from ..engines.processes.stopping import Stopped, stoppable
    from ..measure.speed.timing import Budget
    from ..report.output import files as output
    from ..study import study

    def progress(doing: str) -> None:
        if stopping():
            raise Stopped
        show(f"{scene.name}: {doing}")

    budget = Budget(rounds=20, seconds=0.15)
    if options.full:
        budget = Budget(rounds=100, seconds=60.0, full=True, point_s=10.0)
    try:
        with stoppable() as stopping:
            accuracy = options.accuracy or "balanced"
            result = study(scene, options.engines, request, budget, progress, accuracy, options.result)
            if options.full:
                result = _in_full(result, options, progress)
            stopped = stopping()
    except Stopped:
        raise KeyboardInterrupt from None
    if stopped:
        result.reasons.append("stopped by the user; what is not here was not done")
    show(f"{scene.name}: writing the report")
    changed = _since(options.baseline[scene.name], result) if options.baseline and not stopped else None
    folder = output.write(result, options.out, changed, complete=not stopped)
    print_result(result)
    show_page("report", folder / "report.html", "what was done" if stopped else "", options)
    if not options.check:
        return False
    from ..judge.canaries.canaries import canaries

    result.let_through.extend(canaries(result))
    worse = [str(change) for change in changed or () if change.worse]
    return stops(scene, {scene.name: result}, options.format, worse)


def _since(old: "Summary", result: "Study") -> list["Change"]:
    """What changed since a baseline, which is added to what the user should know."""
    from ..ci.baseline import Summary, changes
    from ..report.output.files import summary
    from ..report.plain import json_text

    changed = changes(old, Summary.model_validate_json(json_text(summary(result))))
    result.reasons.extend(map(str, changed) if changed else ["nothing changed since the baseline"])
    return changed


def _in_full(result: "Study", options: Namespace, progress: Callable[[str], None]) -> "Study":
    """The study with maps of stability and the hard cases, as far as the user lets it."""
    from scenes.hard import catalogue, ladder

    from ..measure.hard.cases import hard_cases
    from ..measure.hard.stability import stability_table

    able = [engine for engine in options.engines if not registry.ENTRIES[engine].missing]
    to_lock = [(rung.label, rung.scene()) for rung in ladder("lock_rrr").rungs]
    maps = stability_table(result.scene, able, to_lock, progress)
    hard = hard_cases(catalogue(), able, options.out, progress, result.reasons.append)
    return replace(result, maps=maps, hard=hard)
