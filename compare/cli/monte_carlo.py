"""Machines drawn from a scene's tolerances: `python -m compare.run --monte-carlo`."""

from argparse import Namespace
from collections.abc import Callable

from scenes import Sampling, Scene

from .printing import show_page, stops


def run(scene: Scene, request: Sampling, options: Namespace, show: Callable[[str], None]) -> bool:
    """Write what one scene's tolerances do, and return whether the linkage as drawn misses a tolerance.

    Raises:
        KeyboardInterrupt: the user stopped; what was solved till then is written.
    """
    from ..judge.canaries.canaries import canaries
    from ..measure.many.study import begun, solved
    from ..report.output import files as output
    from ..report.tables.monte_carlo import ran, verdicts

    def progress(doing: str) -> None:
        show(f"{scene.name}: {doing}")

    study = begun(scene, options.monte_carlo, options.seed or 0, options.engines, request, progress)
    try:
        for block in solved(study):
            study.blocks.append(block)
            progress(f"{study.count:,} of {study.asked:,} machines")
    except KeyboardInterrupt:
        if not study.blocks:
            raise
    progress("writing the report")
    page = output.write_monte_carlo(study, options.out) / "monte_carlo.html"
    for sentence in (ran(study), *verdicts(study)):
        print(f"{scene.name}  {sentence}")
    done = f"the {study.count} of {study.asked} machines that were done"
    show_page("tolerances", page, "" if study.complete else done, options)
    none = () if study.running else ("every tolerance, since no drawn machine runs",)
    study.judged.let_through.extend(canaries(study.judged) if options.check else ())
    return bool(options.check) and stops(scene, {scene.name: study.judged}, options.format, none)
