"""What the figures were obtained on."""

import os
import platform
from functools import cache
from importlib.metadata import version

PACKAGES = ("linkage-crosscheck", "numpy", "scipy", "pandas", "plotly")  # the engines name their own


@cache
def environment() -> dict[str, str]:
    """Return the machine's and the packages' versions."""
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
    } | {package: version(package) for package in PACKAGES}
