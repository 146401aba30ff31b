"""What `python -m compare.run` prints about results, and the page it opens."""

from argparse import Namespace
from collections.abc import Mapping, Sequence
from math import isnan, nan
from pathlib import Path
from typing import TYPE_CHECKING

from scenes import Scene
from scenes.errors import nearest

if TYPE_CHECKING:
    from ..judge.agreement import Judgement
    from ..study import Study


def print_result(result: "Study") -> None:
    """Print the verdict, a line an engine, the reasons and causes."""
    from ..judge.errors import shown_groups
    from ..report.tables import speed as speed_tables
    from ..report.tables.study import verdict

    groups = shown_groups(result.scene)
    print(f"{result.scene.name}  {verdict(result)}")
    for m in result.measurements:
        worst = m.worst()
        errors = "  ".join(f"{group} {worst[group]:.1e}" for group in groups if not isnan(worst.get(group, nan)))
        print(f"{result.scene.name}  {m.run.engine:14} {m.run.status.name:15} {errors}")
    known = [f"{m.run.engine}: {m.run.reason}" for m in result.measurements if m.run.reason]
    known += [f"likely cause: {cause}" for cause in result.causes.values()]
    for sentence in (*known, *result.reasons, speed_tables.verdict(result)):
        print(f"{result.scene.name}  {sentence}")


def stops(scene: Scene, judged: Mapping[str, "Judgement"], output_format: str, more: Sequence[str] = ()) -> bool:
    """Name every tolerance that was missed and every engine that failed, and return whether there is any.

    What was judged is by name; with `github` as format there are annotations and a step summary besides.
    """
    from ..ci import github
    from ..engines import registry
    from ..judge.gates import Miss

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
