"""The hard cases: every engine on every rung of every ladder, in processes of their own, kept as they come."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from scenes import hard

from ...engines import registry
from ...engines.kept import Kept
from ...engines.processes.inside import Ended, Limits
from ...engines.processes.isolation import isolated
from ...engines.processes.stopping import kept as until_stopped
from .case import Case, Outcome, case_row, examine

PARTIAL = "hard.partial.jsonl"


def hard_cases(
    ladders: Sequence[str],
    engines: Sequence[str],
    folder: Path,
    progress: Callable[[str], None],
    note: Callable[[str], None],
) -> pd.DataFrame:
    """One row an attempt, in the order of the ladders.

    Results are kept in `folder` as they come, and what is kept there is not done again until `forget` is called. A stop
    leaves what is done, there and in what is returned. Where nothing can be kept there, that is noted.
    """
    limits = Limits()
    rungs = [(name, rung.label) for name in ladders for rung in hard.ladder(name).rungs]
    wanted = [Case(*rung, engine) for rung in rungs for engine in engines]
    kept = Kept(folder / PARTIAL, limits)
    rows = dict(kept.read())
    left = [case for case in wanted if str(case) not in rows]

    def poll() -> None:
        progress(f"hard cases, {len(rows)} of {len(wanted)} done")

    for case, result in until_stopped(isolated(examine, left, limits, poll)):
        if isinstance(result, Ended):  # of the reference it is arbitrary precision that gave no answer
            outcome = Outcome.uncertified if case.engine == registry.REFERENCE else Outcome.refused
            result = [case_row(case, result.status.name, result.reason, "isolation", outcome)]
        rows[str(case)] = result
        kept.add(str(case), result)
    if kept.trouble:
        note(kept.trouble)
    return pd.DataFrame([row for case in wanted for row in rows.get(str(case), [])])


def forget(folder: Path) -> None:
    """Drop what is kept: a command that came to its end starts anew the next time."""
    Kept(folder / PARTIAL, "").forget()
