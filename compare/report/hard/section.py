"""What the report's section about the hard cases shows."""

from typing import Any

import pandas as pd

from ...engines.settings import tiers


def hard_cases(cases: pd.DataFrame) -> dict[str, Any]:
    """Return what the section's template uses, by name; nothing where no case was run."""
    if cases.empty:
        return {}
    from . import tables  # late: most pages have none
    from .figure import over_condition

    promises = (f"{name} {tiers(name)['balanced'].promise:.0e}" for name in dict.fromkeys(cases["engine"]))
    return {
        "verdict": tables.verdict(cases),
        "promises": ", ".join(promises),
        "counts": tables.counts(cases),
        "figure": over_condition(cases),
        "ladders": [*tables.ladders(cases)],
        "digits": tables.digits(cases),
    }
