"""`python -m compare.run`: from scene names to reports."""

import sys

from .command_line import command, shown_progress, starting

with starting(__name__):
    import argparse
    from collections.abc import Callable, Mapping, Sequence
    from contextlib import nullcontext
    from dataclasses import replace
    from pathlib import Path
    from typing import TYPE_CHECKING

    from scenes import InputError, Sampling, Scene, load, numbers_in, shipped, write_starter

    from .arguments import parser, sampling
    from .engines import registry
    from .family.grid import grid
    from .prediction import announce

    if TYPE_CHECKING:
        from .judge.judgement import Judgement
        from .study import Study

TO_LOCK = "lock_rrr"  # ladder of the map of stability next to a singular configuration


@command
def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, 1 for a missed tolerance, 2 for bad input."""
    options = parser().parse_args(arguments)
    if options.list:
        return _list()
    if options.new:
        print("wrote", " and ".join(map(str, write_starter(options.new))))
        return 0
    return _run(options)


def _list() -> int:
    width = max(map(len, (*shipped(), *registry.ENTRIES)))
    for name in shipped():
        print(f"scene   {name:{width}}  {load(name).title}")
    for name, entry in registry.ENTRIES.items():
        print(f"engine  {name:{width}}  {entry.purpose} ({entry.missing or entry.version})")
    return 0


def _run(options: argparse.Namespace) -> int:
    scenes = [load(name) for name in options.scenes]
    requests = [sampling(scene, options.samples, options.turns, options.channels) for scene in scenes]
    _check(options, scenes)
    for scene, request in zip(scenes, requests, strict=True):
        announce(scene, request, options.engines, len(grid(options.vary)) if options.vary else 0)

    from .report import files  # late: slow to import, and bad input should be named at once
    from .report.origin import check_origin
    from .report.placing import check_writable

    run, own = (_family, files.FAMILY) if options.vary else (_report, files.REPORT)
    if options.monte_carlo:
        run, own = _monte_carlo, files.MONTE_CARLO
    places = {f"{scene.name}{end}": scene for scene in scenes for end in ("", files.PARTIAL)}
    check_writable(options.out, places, own)
    for name, scene in places.items():
        check_origin(scene, options.out / name)
    with shown_progress() as show:
        missed = [run(scene, request, options, show) for scene, request in zip(scenes, requests, strict=True)]
    if options.full:
        from .hard.cases import forget

        forget(options.out)
    return 1 if any(missed) else 0


def _check(options: argparse.Namespace, scenes: Sequence[Scene]) -> None:
    """Raise InputError for arguments that do not fit the scenes."""
    names = [scene.name for scene in scenes]
    for scene in scenes:
        if names.count(scene.name) > 1:
            target = options.out / scene.name
            raise InputError(f"arguments: two scenes are named '{scene.name}', and both would write {target}")
        numbers_in(scene.file, [variation.path for variation in options.vary])
    several = [name for name in ("--vary", "--monte-carlo") if getattr(options, name[2:].replace("-", "_"))]
    for name, why in (
        ("full", "many linkages take one setting of an engine"),
        ("accuracy", "many linkages take the engines' defaults"),
        ("channels", "the numbers are of all of them"),
    ):
        if several and getattr(options, name):
            raise InputError(f"arguments: --{name}: expected it without {several[0]}, since {why}")
    if len(several) > 1:
        raise InputError("arguments: --vary: expected it without --monte-carlo, since each has linkages of its own")
    if options.monte_carlo:
        for scene in scenes:
            if not scene.variations:
                raise InputError(f"{scene.file}: variations: missing; --monte-carlo draws machines from them")
    elif options.seed is not None:
        raise InputError("arguments: --seed: expected it with --monte-carlo, whose draws it picks")
    if _many(options):
        if not options.vary:
            raise InputError("arguments: --workers, --scheduler: expected with --vary, since they take its members")
        from .engines.cluster import check_installed

        check_installed()


def _report(scene: Scene, request: Sampling, options: argparse.Namespace, show: Callable[[str], None]) -> bool:
    """Write one scene's report, and return whether it misses a tolerance.

    Raises:
        KeyboardInterrupt: the user stopped; what was done till then is written, if there is a reference to report on.
    """
    from .engines.stopping import Stopped, stoppable
    from .report import files as output
    from .speed.timing import Budget
    from .study import study

    def progress(doing: str) -> None:
        if stopping():
            raise Stopped
        show(f"{scene.name}: {doing}")

    budget = Budget(rounds=20, seconds=0.3)
    if options.full:
        budget = Budget(rounds=100, seconds=60.0, full=True, point_s=10.0)
    try:
        with stoppable() as stopping:
            result = study(scene, options.engines, request, budget, progress, options.accuracy or "balanced")
            if options.full:
                result = _in_full(result, options, progress)
            stopped = stopping()
    except Stopped:
        raise KeyboardInterrupt from None
    if stopped:
        result.reasons.append("stopped by the user; what is not here was not done")
    show(f"{scene.name}: writing the report")
    folder = output.write(result, options.out, complete=not stopped)
    _print_result(result)
    page = folder / "report.html"
    print(f"report: {page}")
    if stopped:
        raise KeyboardInterrupt(f"stopped; {page} has what was done")
    if options.open:
        _open(page)
    return bool(options.check) and _stops(scene, {scene.name: result})


def _in_full(result: "Study", options: argparse.Namespace, progress: Callable[[str], None]) -> "Study":
    """Return the study with maps of stability and the hard cases, as far as the user lets it."""
    from scenes.hard import catalogue, ladder

    from .hard.cases import hard_cases
    from .hard.stability import stability_table

    able = [engine for engine in options.engines if not registry.ENTRIES[engine].missing]
    to_lock = [(rung.label, rung.scene()) for rung in ladder(TO_LOCK).rungs]
    maps = stability_table(result.scene, able, to_lock, progress)
    hard = hard_cases(catalogue(), able, options.out, progress, result.reasons.append)
    return replace(result, maps=maps, hard=hard)


def _family(scene: Scene, request: Sampling, options: argparse.Namespace, show: Callable[[str], None]) -> bool:
    """Write one scene's family, and return whether a member misses a tolerance, or none runs.

    Raises:
        KeyboardInterrupt: the user stopped; what was solved till then is written.
    """
    from .engines.cluster import cluster
    from .family.family import Family
    from .family.going_on import going_on, kept_members
    from .report import files as output
    from .report.family.tables import label, on_a_line

    def progress(doing: str) -> None:
        show(f"{scene.name}: member {len(family.members) + 1} of {len(changes)}: {doing}")

    changes = grid(options.vary)
    family = Family(scene, options.vary, options.engines)
    kept = kept_members(options.out, scene, options.engines, request)
    stopped = False
    try:
        with cluster(options.workers, options.scheduler) if _many(options) else nullcontext() as client:
            for member in going_on(kept, scene.file, changes, options.engines, request, client, progress):
                family.members.append(member)
                print(f"{scene.name}  {on_a_line(family, member)}")
    except KeyboardInterrupt:
        if not family.members:
            raise
        stopped = True
    family.members.sort(key=lambda member: changes.index(member.changes))
    progress("writing the report")
    page = output.write_family(family, options.out) / "family.html"
    print(f"family: {page}")
    if family.complete:
        kept.forget()
    if kept.trouble:
        print(f"{scene.name}  {kept.trouble}")
    if stopped:
        raise KeyboardInterrupt(
            f"stopped; {page} has the {len(family.members)} of {len(changes)} members that were done"
        )
    if options.open:
        _open(page)
    able = {f"{scene.name}  {label(family, m)}": m.judgement for m in family.members if m.judgement is not None}
    if options.check and not able:
        print(f"{scene.name}  missed: every tolerance, since no member runs")
        return True
    return bool(options.check) and _stops(scene, able)


def _many(options: argparse.Namespace) -> bool:
    return bool(options.workers or options.scheduler)


def _monte_carlo(scene: Scene, request: Sampling, options: argparse.Namespace, show: Callable[[str], None]) -> bool:
    """Write what one scene's tolerances do, and return whether the linkage as drawn misses a tolerance.

    Raises:
        KeyboardInterrupt: the user stopped; what was solved till then is written.
    """
    from .monte_carlo.study import begun, solved
    from .report import files as output
    from .report.monte_carlo.tables import ran, verdicts

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
    print(f"tolerances: {page}")
    if not study.complete:
        raise KeyboardInterrupt(f"stopped; {page} has the {study.count} of {study.asked} machines that were done")
    if options.open:
        _open(page)
    return bool(options.check) and _stops(scene, {scene.name: study.judged})


def _open(page: Path) -> None:
    import webbrowser

    if not webbrowser.open(page.resolve().as_uri()):
        print(f"{page}: no browser was found to open it")


def _print_result(result: "Study") -> None:
    from .judge.errors import shown_groups
    from .report.speed import tables as speed_tables
    from .report.tables import overview, verdict

    groups = shown_groups(result.scene)
    print(f"{result.scene.name}  {verdict(result)}")
    for row in overview(result).to_dict("records"):
        errors = "  ".join(f"{group} {row[group]:.1e}" for group in groups if row[group] == row[group])
        print(f"{result.scene.name}  {row['engine']:14} {row['status']:15} {errors}")
    for m in result.measurements:
        if m.run.reason:
            print(f"{result.scene.name}  {m.run.engine}: {m.run.reason}")
    for cause in result.causes.values():
        print(f"{result.scene.name}  likely cause: {cause}")
    for sentence in (*result.reasons, speed_tables.verdict(result)):
        print(f"{result.scene.name}  {sentence}")


def _stops(scene: Scene, judged: Mapping[str, "Judgement"]) -> bool:
    """Name every tolerance that was missed and every engine that failed, given by what the judgements are about.

    The comparison itself is checked with the first of them.
    """
    from .faults.canaries import canaries

    for judgement in [*judged.values()][:1]:
        judgement.let_through.extend(canaries(judgement))
    if not any(judgement.held for judgement in judged.values()):
        print(f"{scene.name}  no tolerance is declared for these engines; each is held to its promise")
    lines = [f"{name}  missed: {line}" for name, judgement in judged.items() for line in judgement.missed]
    for line in lines:
        print(line)
    return bool(lines)


if __name__ == "__main__":
    sys.exit(main())
