"""`python -m papers.audit`: what the two source papers print against what is computed."""

import sys

from compare.cli.command import Parser, command, shown_progress, starting

with starting(__name__):
    import re
    from collections import Counter
    from collections.abc import Mapping, Sequence
    from dataclasses import asdict
    from pathlib import Path

    from markupsafe import Markup, escape

    from compare.engines.processes.stopping import Progress
    from compare.judge.floor import establish
    from compare.report.output.placing import check_writable, placed
    from compare.report.pages.html import render
    from compare.report.plain import json_text
    from compare.report.tables import TableRows
    from compare.report.tables.study import floors
    from scenes import load

    from .claims import Claim, Verdict
    from .clamp import claims as clamp
    from .clamp.printed import SCENES
    from .toggle_press import claims as toggle_press

FILES = ("audit.html", "audit.json")
COLUMNS = ("claim", "printed", "computed", "residual", "verdict", "corrected", "residual")
GREEK = {"alpha": "α", "gamma": "γ", "epsilon": "ε", "theta": "θ", "omega": "ω"}


@command
def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit status: 0, or 2 for bad input."""
    parser = Parser("python -m papers.audit", "python -m papers.audit [--out DIR]", "Audit the two source papers.")
    parser.add_out("the audit")
    options = parser.parse_args(arguments)
    check_writable(options.out, ["audit"], FILES)
    with shown_progress() as show:
        claims, notes = audit(lambda doing: show("audit", doing))
        show("audit: writing the page")
        folder = write(claims, notes, options.out)
    for source, rows in claims.items():
        counts = Counter(claim.verdict for claim in rows)
        print(f"{source}  {', '.join(f'{count} {verdict}' for verdict, count in counts.items())}")
    print(f"audit: {folder / 'audit.html'}")
    return 0


def audit(progress: Progress) -> tuple[dict[str, list[Claim]], list[str]]:
    """Every claim by its source, with its verdict, and what a reader has to know."""
    progress("certifying the motions")
    notes = list(floors(establish(load(name)).floor for name in (*toggle_press.SCENES, *SCENES.values())))
    progress(f"the {toggle_press.SOURCE}")
    press = list(toggle_press.claims())
    progress(f"the {clamp.SOURCE}")
    by_reference = list(clamp.claims())
    progress(f"the {clamp.SOURCE} by the engines")
    by_engines = list(clamp.by_engines(notes.append))
    return {toggle_press.SOURCE: press, clamp.SOURCE: [*by_reference, *by_engines]}, notes


def write(claims: Mapping[str, Sequence[Claim]], notes: Sequence[str], folder: Path) -> Path:
    """Write all into `folder/audit/` and return that; InputError where that cannot be, which leaves what was there."""
    page = render(
        "audit.html",
        "papers",
        formula=_formula,
        overview=overview(claims),
        notes=notes,
        claims=claims,
        columns=COLUMNS,
        pictures=(*toggle_press.figures(), *clamp.figures()),
    )
    rows = [
        {"source": source} | asdict(claim) | {"verdict": str(claim.verdict)}
        for source, of_source in claims.items()
        for claim in of_source
    ]  # printed numbers keep their digits as text
    with placed(folder, "audit", FILES) as aside:
        (aside / "audit.json").write_text(json_text(rows), encoding="utf-8")
        (aside / "audit.html").write_text(page, encoding="utf-8")
    return folder / "audit"


def overview(claims: Mapping[str, Sequence[Claim]]) -> TableRows:
    """How many claims of each source came out how."""
    counts = {source: Counter(claim.verdict for claim in rows) for source, rows in claims.items()}
    return [{"source": source} | {str(each): count[each] for each in Verdict} for source, count in counts.items()]


def _formula(written: str) -> Markup:
    """A formula as HTML: letters in Greek, what follows _ and e^ below and above the line."""
    greek = re.sub("|".join(GREEK), lambda name: GREEK[name[0]], str(escape(written)))
    # The text is escaped before any tag is put in, so that the result may be marked as safe.
    below = re.sub(r"_(\w+)", r"<sub>\1</sub>", greek)
    return Markup(re.sub(r"e\^(iθ[₁-₅]?)", r"e<sup>\1</sup>", below))  # escaped above


if __name__ == "__main__":
    sys.exit(main())
