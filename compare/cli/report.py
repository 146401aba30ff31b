"""What is done with a scene: a report, a family, draws from its tolerances; what is printed, and the page it opens.

A command that the user stops reports on what was solved till then, and ends by KeyboardInterrupt.
"""

from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from math import isnan, nan
from pathlib import Path
from typing import Any

from scenes import Sampling, Scene
from scenes.errors import nearest

from ..engines import registry
from ..engines.processes.stopping import Stopped, stoppable
from ..engines.runner import processor_time
from ..judge.agreement import Judgement
from ..judge.errors import shown_groups
from ..judge.floor import UnsolvedError, solvable
from ..judge.measure import Miss
from ..measure.many.grid import grid
from ..measure.speed.share import MAX_SHARE
from ..measure.speed.speed_table import NO_CLOCK, QUICK, Budget
from ..mechanics.axis import grouped
from ..report.output import files
from ..report.output.earlier import Change, Summary, before, last
from ..report.plain import plain
from ..report.tables import proof
from ..report.tables import speed as speed_tables
from ..study import Study, judged, study


def run(scene: Scene, request: Sampling, options: Namespace, show: Callable[..., None]) -> bool:
    """Write one scene's report, and return whether it misses a tolerance."""

    def progress(doing: str) -> None:
        if stopping():
            raise Stopped
        show(doing)

    budget = NO_CLOCK if options.no_speed else replace(QUICK, share=MAX_SHARE, since=options.since)
    if options.full:
        budget = Budget(rounds=100, seconds=60.0, full=True, point_s=10.0)
    with stoppable() as stopping:
        accuracy = options.accuracy or "balanced"
        result = study(scene, options.engines, request, budget, progress, accuracy, options.result)
        if options.full:
            result = _in_full(result, options, progress)
        stopped, options.since = stopping(), processor_time()
    if stopped:
        result.reasons.append("stopped by the user; what is not here was not done")
    show("writing the report")
    since = {} if stopped else _since(scene, options, partial(files.summary, result))
    if (changed := since.get("since_baseline")) is not None:
        result.reasons.extend(map(str, changed) if changed else ["nothing changed since the baseline"])
    drawn = before(options.baseline[scene.name], options.against, scene) if options.against else None
    if drawn and not drawn.motion.samples:
        result.reasons.append("of the run before no motion is at hand: motion.analytic.csv beside its summary is drawn")
    folder = files.write(result, options.out, since, drawn, complete=not stopped)
    print_result(result)
    show_page("report", folder / "report.html", "what was done" if stopped else "", options)
    if not options.check:
        return False
    from ..judge.canaries.canaries import canaries

    result.let_through.extend(canaries(result))
    worse = [str(change) for change in changed or () if change.worse]
    return stops(scene, {scene.name: result}, options.format, worse)


def unsolved(scene: Scene, request: Sampling, options: Namespace, why: UnsolvedError) -> None:
    """Write the report of a scene that the reference cannot solve: how far it goes, and why no further."""
    known = files.unsolved_summary(scene, request, why)
    folder = files.write_unsolved(scene, why, options.out, known | _since(scene, options, lambda: known))
    show_page("report", folder / "report.html", "", options)


def _since(scene: Scene, options: Namespace, known: Callable[[], Mapping[str, Any]]) -> dict[str, list[Change]]:
    """What changed since the baseline and since the last run, where there is one, of what is known for the summary."""
    old = {"since_baseline": (options.baseline or {}).get(scene.name), "since_last_run": last(options.out, scene)}
    if not any(old.values()):
        return {}
    from ..ci.baseline import changes  # late, as what a first run needs none of

    new = Summary.model_validate(plain(known()))
    return {name: changes(earlier, new) for name, earlier in old.items() if earlier}


def _in_full(result: Study, options: Namespace, progress: Callable[[str], None]) -> Study:
    from scenes.hard import catalogue, ladder

    from ..measure.hard.case import hard_cases
    from ..measure.hard.stability import stability_table

    able = [engine for engine in options.engines if not registry.ENTRIES[engine].missing]
    to_lock = [(rung.label, rung.scene()) for rung in ladder("lock_rrr").rungs]
    maps = stability_table(result.scene, able, to_lock, progress)
    hard = hard_cases(catalogue(), able, options.out, progress, result.reasons.append)
    return replace(result, maps=maps, hard=hard)


def print_result(result: Study) -> None:
    """Print the verdict, a line an engine, the reasons and causes."""
    lines = [str(result.agreement), *proof.sentences(result)]
    for m in result.measurements:
        worst = m.worst()
        errors = "  ".join(f"{g} {worst[g]:.1e}" for g in shown_groups(result.scene) if not isnan(worst.get(g, nan)))
        lines.append(f"{m.run.engine:14} {m.run.status.name:15} {errors}")
    lines += [f"{m.run.engine}: {m.run.reason}" for m in result.measurements if m.run.reason]
    lines += [f"likely cause: {cause}" for cause in result.causes.values()]
    for line in filter(None, (*lines, *result.reasons, speed_tables.verdict(result), speed_tables.left_out(result))):
        print(f"{result.scene.name}  {line}")


def stops(scene: Scene, judged: Mapping[str, Judgement], output_format: str, more: Sequence[str] = ()) -> bool:
    """Name every tolerance that was missed and every engine that failed, and return whether there is any.

    What was judged is by name; with `github` as format there are annotations and a step summary besides.
    """
    if judged and not any(judgement.held for judgement in judged.values()):
        print(f"{scene.name}  no tolerance is declared for these engines; each is held to its promise")
    run = {m.run.engine for judgement in judged.values() for m in judgement.measurements}
    for name in sorted(scene.tolerances.keys() - registry.ENTRIES.keys() - run):
        print(f"{scene.name}  not held: tolerances.{name}: no engine of that name{nearest(name, registry.ENTRIES)}")
    misses = {name: judgement.misses for name, judgement in judged.items()}
    misses.setdefault(scene.name, []).extend(Miss("", "", text) for text in more)
    for name, missed in misses.items():
        for miss in missed:
            print(f"{name}  missed: {miss.text}")
        for gate in judged[name].held if name in judged else ():
            if not gate.held:
                print(f"{name}  not held: {gate}")
    if output_format == "github":
        from ..ci import github

        github.report(scene, judged, misses)
    return any(misses.values())


def show_page(what: str, page: Path, unfinished: str, options: Namespace) -> None:
    """Print where a page is, and open it in the browser where that is asked for and there is one.

    `unfinished` is what it has where the user stopped, which raises KeyboardInterrupt; nothing where all is done.
    """
    print(f"{what}: {page}")
    if unfinished:
        raise KeyboardInterrupt(f"stopped; {page} has {unfinished}")
    if options.open:
        import webbrowser

        if not webbrowser.open(page.resolve().as_uri()):
            print(f"{page}: no browser was found to open it")


def family(scene: Scene, request: Sampling, options: Namespace, show: Callable[..., None]) -> bool:
    """Write one scene's family, and return whether a member misses a tolerance, or none runs."""
    from ..engines.processes.cluster import cluster
    from ..measure.many.family import Asked, Family
    from ..measure.many.going_on import by_processes, going_on, kept_members
    from ..report.tables.family import agreement, label, on_a_line

    members = grid(options.vary)
    family = Family(scene, options.vary, options.engines)

    def progress(doing: str) -> None:
        show(f"member {len(family.members) + 1} of {len(members)}", doing)

    asked = Asked(scene, options.engines, request)
    kept = kept_members(options.out, scene, asked)
    here = by_processes(options.workers) if options.workers else None
    try:
        with cluster(options.scheduler) if options.scheduler else nullcontext(here) as spread:
            for member in going_on(kept, asked, members, spread, progress):
                family.members.append(member)
                print(f"{scene.name}  {on_a_line(family, member)}")
    except KeyboardInterrupt:
        if not family.members:
            raise
    family.members.sort(key=lambda member: members.index(member.changes))
    progress("writing the report")
    page = files.write_family(family, options.out) / "family.html"
    print(f"{scene.name}  {agreement(family)}")
    if family.complete:
        kept.forget()
    if kept.trouble:
        print(f"{scene.name}  {kept.trouble}")
    done = f"the {len(family.members)} of {len(members)} members that were done"
    show_page("family", page, "" if family.complete else done, options)
    if not options.check:
        return False
    able = {f"{scene.name}  {label(family, m)}": m.judgement for m in family.members if m.judgement is not None}
    # The canaries need the motions, which a family's members have dropped: the judgement of the scene as its file has
    # it is made once more and its undetected faults are counted for the first member.
    for first in [*able.values()][:1]:  # whose motions are gone: the comparison itself is checked with others
        first.let_through.extend(judged(first.scene, options.engines, request).let_through)
    return stops(scene, able, options.format, () if able else ("every tolerance, since no member runs",))


def assemblies(scene: Scene, _: Sampling, options: Namespace, show: Callable[..., None]) -> bool:
    """Write all assemblies of a scene, and return that no tolerance was missed: none is looked at, nor any sample."""
    show("all assemblies")
    with solvable(scene):
        every = registry.assemblies(scene)
    folder = files.write_assemblies(scene, every, options.out)
    print(f"{scene.name}  {proof.how_many(scene, every)}")
    for row in proof.assemblies(scene, every):
        print(f"{scene.name}  {', '.join(f'{name} {value}' for name, value in row.items() if value)}")
    show_page("assemblies", folder / "assemblies.html", "", options)
    return False


def monte_carlo(scene: Scene, request: Sampling, options: Namespace, show: Callable[..., None]) -> bool:
    """Write what one scene's tolerances do, and return whether the linkage as drawn misses a tolerance."""
    from ..judge.canaries.canaries import canaries
    from ..measure.many.study import begun, solved
    from ..report.tables.monte_carlo import ran, verdicts

    study = begun(scene, options.monte_carlo, options.seed or 0, options.engines, request, show)
    try:
        for block in solved(study):
            study.blocks.append(block)
            show(f"{grouped(study.count)} of {grouped(study.asked)} machines")
    except KeyboardInterrupt:
        if not study.blocks:
            raise
    show("writing the report")
    page = files.write_monte_carlo(study, options.out) / "monte_carlo.html"
    for sentence in (ran(study), *verdicts(study)):
        print(f"{scene.name}  {sentence}")
    done = f"the {study.count} of {study.asked} machines that were done"
    show_page("tolerances", page, "" if study.complete else done, options)
    if not options.check:
        return False
    study.judged.let_through.extend(canaries(study.judged))
    none = () if study.running else ("every tolerance, since no drawn machine runs",)
    return stops(scene, {scene.name: study.judged}, options.format, none)
