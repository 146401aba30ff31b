"""Many linkages: a family, by `python -m compare.run --vary`, and machines drawn from a scene's tolerances.

A command that the user stops reports on what was solved till then, and ends by KeyboardInterrupt.
"""

from argparse import Namespace
from collections.abc import Callable
from contextlib import nullcontext

from scenes import Sampling, Scene

from ..measure.many.grid import grid
from .report import show_page, stops


def family(scene: Scene, request: Sampling, options: Namespace, show: Callable[[str], None]) -> bool:
    """Write one scene's family, and return whether a member misses a tolerance, or none runs."""
    from ..engines.processes.cluster import cluster
    from ..measure.many.family import Asked, Family
    from ..measure.many.going_on import going_on, kept_members
    from ..report.output import files as output
    from ..report.tables.family import agreement, label, on_a_line
    from ..study import judged

    def progress(doing: str) -> None:
        show(f"{scene.name}: member {len(family.members) + 1} of {len(changes)}: {doing}")

    changes = grid(options.vary)
    family = Family(scene, options.vary, options.engines)
    asked = Asked(scene.file, options.engines, request)
    kept = kept_members(options.out, scene, asked)
    stopped, several = False, options.workers or options.scheduler
    try:
        with cluster(options.workers, options.scheduler) if several else nullcontext() as client:
            for member in going_on(kept, asked, changes, client, progress):
                family.members.append(member)
                print(f"{scene.name}  {on_a_line(family, member)}")
    except KeyboardInterrupt:
        if not family.members:
            raise
        stopped = True
    family.members.sort(key=lambda member: changes.index(member.changes))
    progress("writing the report")
    page = output.write_family(family, options.out) / "family.html"
    verdict = agreement(family)
    print(f"{scene.name}  {verdict.word}: {verdict.sentence}")
    if family.complete:
        kept.forget()
    if kept.trouble:
        print(f"{scene.name}  {kept.trouble}")
    done = f"the {len(family.members)} of {len(changes)} members that were done"
    show_page("family", page, done if stopped else "", options)
    if not options.check:
        return False
    able = {f"{scene.name}  {label(family, m)}": m.judgement for m in family.members if m.judgement is not None}
    for first in [*able.values()][:1]:  # whose motions are gone: the comparison itself is checked with others
        first.let_through.extend(judged(first.scene, options.engines, request).let_through)
    return stops(scene, able, options.format, () if able else ("every tolerance, since no member runs",))


def monte_carlo(scene: Scene, request: Sampling, options: Namespace, show: Callable[[str], None]) -> bool:
    """Write what one scene's tolerances do, and return whether the linkage as drawn misses a tolerance."""
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
    if not options.check:
        return False
    study.judged.let_through.extend(canaries(study.judged))
    none = () if study.running else ("every tolerance, since no drawn machine runs",)
    return stops(scene, {scene.name: study.judged}, options.format, none)
