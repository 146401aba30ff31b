"""`python -m benchmarks.publishing.constraints`: constraints.txt, the versions that this environment has.

Of the packages that pyproject.toml names, with all extras that are installed, and of those that they need in turn.
"""

import re
import tomllib
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from platform import python_version

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
FILE = ROOT / "constraints.txt"
OWN = "linkage-crosscheck"
HEAD = f"""# The versions that the tests ran with, by Python {python_version()}: pip install -c constraints.txt ...
# Made by `python -m benchmarks.publishing.constraints` in the environment that was tested.
"""


def declared() -> set[Requirement]:
    """What pyproject.toml names, with all extras."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    texts = [*project["dependencies"], *(text for extra in project["optional-dependencies"].values() for text in extra)]
    return {known for text in texts if (known := Requirement(text)).name != OWN}


def versions() -> dict[str, str]:
    """The version that is installed of each package that is needed, however far down, by its name."""
    found: dict[str, str] = {}
    left = [*declared()]
    seen: set[tuple[str, frozenset[str]]] = set()
    # A transitive closure over installed packages: a requirement counts where its marker holds here, with the extras
    # that it is asked for with. A package that is asked for with other extras is visited again, since more may follow
    # from these.
    while left:
        wanted = left.pop()
        name, extras = canonicalize_name(wanted.name), frozenset(wanted.extras)
        if (name, extras) in seen or not _applies(wanted, {""}):
            continue
        seen.add((name, extras))
        try:
            installed = distribution(wanted.name)
        except PackageNotFoundError:
            continue
        found[name] = re.sub(r"\+.*", "", installed.version)  # without a local build's own mark
        left += [need for text in installed.requires or () if _applies(need := Requirement(text), {"", *extras})]
    return found


def _applies(wanted: Requirement, extras: set[str]) -> bool:
    return wanted.marker is None or any(wanted.marker.evaluate({"extra": extra}) for extra in extras)


def lines() -> Iterator[str]:
    """Yield one package each, in the order of their names."""
    yield from (f"{name}=={version}" for name, version in sorted(versions().items()))


if __name__ == "__main__":
    FILE.write_text(HEAD + "".join(f"{line}\n" for line in lines()), encoding="utf-8")
