"""`python -m compare.run`: from scene names to reports; and what is no run: `list`, `new`, `map`, `version`."""

import sys

from .cli.command import CONSOLE, called, command, print_line, shown_progress, starting

with starting(__name__):
    import argparse
    from collections.abc import Sequence
    from contextlib import nullcontext
    from functools import partial
    from pathlib import Path
    from typing import Any

    from scenes import InputError, Scene, load, numbers_in, shipped, write_starter
    from scenes.file.reader import title_of

    from .cli.arguments import COMMANDS, parser, sampling
    from .cli.cost import announce
    from .engines import registry
    from .measure.many.grid import grid

# Other commands as options among others.
SPELLINGS = {"--list": "list", "--new": "new", "--version": "version", "--result-mapping": "map"}


@command
def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, 1 for a missed tolerance, 2 for bad input."""
    words = sys.argv[1:] if arguments is None else arguments
    for spelt in filter(SPELLINGS.get, words):
        return _do(SPELLINGS[spelt], [word for word in words if word != spelt])
    if words and words[0] in SPELLINGS.values():
        return _do(words[0], words[1:])
    return _run(parser().parse_args(words))


def _do(name: str, words: Sequence[str]) -> int:
    results = [word for word in words if "=" in word]
    match name, [word for word in words if word not in results], results:
        case "list", _, _:
            width = max(map(len, (*shipped(), *registry.ENTRIES)))
            for scene in shipped():
                print(f"scene   {scene:{width}}  {title_of(scene)}")
            for engine, entry in registry.ENTRIES.items():
                print(f"engine  {engine:{width}}  {entry.purpose} ({entry.missing or entry.version})")
        case "version", _, _:
            from importlib.metadata import version  # late: slow to import

            print(CONSOLE, version(CONSOLE))
        case "new", [path], []:
            print("wrote", " and ".join(map(str, write_starter(Path(path)))))
        case "map", ([] | [_]) as given, [result]:
            from .results.proposal import proposed  # late: slow to import

            print(proposed(load((given or ["toggle_press"])[0]), result), end="")
        case _:
            (usage,) = (usage for usage in COMMANDS if usage.split()[0] == name)
            raise InputError(f"arguments: expected {called()} {usage}, found '{' '.join((name, *words))}'")
    return 0


def _run(options: argparse.Namespace) -> int:
    annotated: Any = nullcontext
    if options.format == "github":
        from .ci.github import refusals as annotated  # late, as below
    scenes, refused = [], 0
    for name in options.scenes:
        try:
            with annotated(name):
                scenes.append(load(name))
        except InputError as error:
            print_line(str(error))
            refused += 1
    if not scenes:
        return 2
    requests = [sampling(scene, options.samples, options.turns, options.channels) for scene in scenes]
    _check(options, scenes)
    if earlier := options.against or options.baseline:
        from .report.output.earlier import read  # late, as below

        option = "--against" if options.against else "--baseline"
        options.baseline = {scene.name: read(earlier, scene, option) for scene in scenes}
    if options.result:
        from .results.result import read_results  # late, as below

        options.result = read_results(scenes, options.result, requests[0].channels)
    for scene, request in zip(scenes, requests, strict=True):
        announce(scene, request, options.engines, len(grid(options.vary)) if options.vary else 0)

    from .cli import report  # late: slow to import, and bad input should be named at once
    from .judge.floor import UnsolvedError
    from .report.output import files
    from .report.output.placing import check_writable

    ways = {
        "vary": (report.family, files.FAMILY),
        "monte_carlo": (report.monte_carlo, files.MONTE_CARLO),
        "assemblies": (report.assemblies, files.ASSEMBLIES),
    }
    run, patterns = next((way for name, way in ways.items() if getattr(options, name)), (report.run, files.REPORT))
    places = {f"{scene.name}{end}": scene for scene in scenes for end in ("", files.PARTIAL)}
    check_writable(options.out, places, patterns)
    for name, scene in places.items():
        files.check_origin(scene, options.out / name)
    missed = []
    try:
        with shown_progress() as show:
            for scene, request in zip(scenes, requests, strict=True):
                try:
                    with annotated(scene.file):
                        missed.append(run(scene, request, options, partial(show, scene.name)))
                except UnsolvedError as why:  # the others go on
                    print_line(str(why))
                    refused += 1
                    if patterns == files.REPORT:
                        report.unsolved(scene, request, options, why)
    finally:  # of those that are done, where the user stops too
        if patterns == files.REPORT and (missed or refused) and options.out.is_dir():
            print(f"index: {files.write_index(options.out)}")
    if options.full:
        from .measure.hard.case import forget

        forget(options.out)
    return 2 if refused else 1 if any(missed) else 0


def _check(options: argparse.Namespace, scenes: Sequence[Scene]) -> None:
    for name in options.engines:
        if name not in registry.DEFAULT_ENGINES and (missing := registry.ENTRIES[name].missing):
            raise InputError(f"--engines {name}: {missing}")
    names = [scene.name for scene in scenes]
    for scene in scenes:
        if names.count(scene.name) > 1:
            target = options.out / scene.name
            raise InputError(f"arguments: two scenes are named '{scene.name}', and both would write {target}")
        numbers_in(scene, [variation.path for variation in options.vary])
    several = next((name for name in ("vary", "monte_carlo", "assemblies") if getattr(options, name)), "")
    for name, why in (
        ("full", "many linkages take one setting of an engine"),
        ("accuracy", "many linkages take the engines' defaults"),
        ("channels", "the numbers are of all of them"),
        ("baseline", "a baseline is of one linkage"),
        ("against", "an earlier run is of one linkage"),
        ("result", "a result is of one linkage"),
    ):
        if several and getattr(options, name):
            raise InputError(f"arguments: --{name}: expected it without --{several.replace('_', '-')}, since {why}")
    if options.monte_carlo:
        for scene in scenes:
            if not scene.variations:
                raise InputError(f"{scene.file}: variations: missing; --monte-carlo draws machines from them")
    elif options.seed is not None:
        raise InputError("arguments: --seed: expected it with --monte-carlo, whose draws it picks")
    if options.format != "plain" and not options.check:
        raise InputError("arguments: --format: expected it with --check, whose misses it annotates")
    if (options.workers or options.scheduler) and not options.vary:
        raise InputError("arguments: --workers, --scheduler: expected with --vary, since they take its members")


if __name__ == "__main__":
    sys.exit(main())
