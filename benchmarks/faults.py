"""`python -m benchmarks.faults`: what is wrong on purpose, and whether the comparison finds it."""

import sys

from compare.cli.command import Parser, command, shown_progress, starting

with starting(__name__):
    from collections.abc import Sequence
    from dataclasses import asdict
    from pathlib import Path

    from compare.report.output.placing import check_writable, placed
    from compare.report.plain import json_text
    from scenes import load
    from tests.faults.page import page
    from tests.faults.rates import SHARES, let_through, rates
    from tests.faults.table import Record, answer_faults
    from tests.faults.wrong_code import comparison_faults, core_faults, shared_faults

USAGE = "python -m benchmarks.faults [--out DIR] [--scenes a,b]"
SCENES = "toggle_press,quick_return,double_toggle_clamp,walking_leg,servo_press"  # laws, tables, press forces, gravity
CORE = 40  # wrong lines
COMPARISON = 60
FILES = ("faults.html", "faults.json", "families.json")


@command
def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, 1 if a fault is let through, 2 for bad input."""
    parser = Parser("python -m benchmarks.faults", USAGE, "Check the checker: spoil what it judges, and its own lines.")
    parser.add_out("the table")
    parser.add_argument("--scenes", default=SCENES, help=f"comma-separated ({SCENES})")
    options = parser.parse_args(arguments)
    scenes = [name.strip() for name in options.scenes.split(",")]
    for name in scenes:
        load(name)
    check_writable(options.out, ["faults"], FILES)
    records: list[Record] = []
    with shown_progress() as show:

        def poll() -> None:
            show(f"faults: {len(records)} judged")

        for found in (
            answer_faults(scenes, poll),
            core_faults(scenes, CORE, poll),
            shared_faults(scenes, poll),
            comparison_faults(scenes[0], COMPARISON, poll),
        ):
            records.extend(found)
    folder = write(records, options.out)
    for row in rates(records).to_dict("records"):
        shares = (f"{100 * row[share]:.3g} % {share.removeprefix('share ')}" for share in SHARES)
        print(f"{row['family']}: {row['above the limit']} above the limit, " + ", ".join(shares))
    print(f"faults: {folder / 'faults.html'}")
    return 1 if len(let_through(records)) else 0


def write(records: Sequence[Record], folder: Path) -> Path:
    """Write `faults.json`, `families.json` and `faults.html` into `folder/faults/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    with placed(folder, "faults", FILES) as aside:
        (aside / "faults.json").write_text(json_text([asdict(record) for record in records]), encoding="utf-8")
        families = rates(records).to_dict("records")
        (aside / "families.json").write_text(json_text(families), encoding="utf-8")
        (aside / "faults.html").write_text(page(records), encoding="utf-8")
    return folder / "faults"


if __name__ == "__main__":
    sys.exit(main())
