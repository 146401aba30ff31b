"""`python -m papers.audit`: what the two source papers print against what is computed."""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from rich.console import Console

from scenes import InputError, load

from .claims import Claim
from .sources import SCENES, claims_of

USAGE = "python -m papers.audit [--out DIR]"
NAME = "audit"  # of the folder


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, or 2 for bad input."""
    try:
        options = _parser().parse_args(arguments)
        from compare.report import files as output

        output.check_writable(options.out)
        with Console(stderr=True).status("") as status:  # says nothing when it is not a terminal
            claims, notes = audit(lambda doing: status.update(f"audit: {doing}"))
            status.update("audit: writing the page")
            folder = write(claims, notes, options.out)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; nothing was written", file=sys.stderr)
        return 130
    for source in dict.fromkeys(claim.source for claim in claims):
        counts = Counter(str(claim.verdict) for claim in claims if claim.source == source)
        print(f"{source}  {', '.join(f'{count} {verdict}' for verdict, count in counts.items())}")
    print(f"audit: {folder / 'audit.html'}")
    return 0


class _Parser(argparse.ArgumentParser):
    """Bad arguments are told in one line, like all bad input."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"arguments: {message}; usage: {USAGE}")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="python -m papers.audit", usage=USAGE, description="Audit the two source papers.")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder for the audit (results)")
    return parser


def audit(progress: Callable[[str], None]) -> tuple[list[Claim], list[str]]:
    """Return every claim of both sources with its verdict, and what a reader has to know."""
    from .clamp.claims import by_engines

    progress("certifying the motions")
    notes = list(_floors())
    claims: list[Claim] = []
    for source in SCENES:
        progress(f"the {source}")
        claims += claims_of(source)
    progress("the clamp by the engines")
    return [*claims, *by_engines(notes.append)], notes


def _floors() -> Iterator[str]:
    """Yield how far the reference may be off on each linkage that is audited."""
    from compare.engines.reference import establish

    for name in (name for names in SCENES.values() for name in names):
        floor = establish(load(name)).floor
        size = f"{max(floor.by_channel.values()):.1e} at most, certified by " if floor.by_channel else ""
        yield f"Floor of the reference on {name}: {size}{floor.by}."


def write(claims: Sequence[Claim], notes: Sequence[str], folder: Path) -> Path:
    """Write `audit.json` and `audit.html` into `folder/audit/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    from compare.report.files import placed

    from .figures import figures
    from .page import page

    with placed(folder, NAME, "audit.*") as aside:
        rows = json.dumps([_plain(claim) for claim in claims], indent=1, ensure_ascii=False, allow_nan=False)
        (aside / "audit.json").write_text(rows + "\n", encoding="utf-8")
        (aside / "audit.html").write_text(page(claims, figures(), notes), encoding="utf-8")
    return folder / NAME


def _plain(claim: Claim) -> dict[str, Any]:
    """Return a row as JSON can hold it: what is not finite becomes null. Printed numbers keep their digits as text."""
    row = {name: value for name, value in asdict(claim).items() if not isinstance(value, float) or isfinite(value)}
    return dict.fromkeys(asdict(claim)) | row


if __name__ == "__main__":
    sys.exit(main())
