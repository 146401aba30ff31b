"""constraints.txt: the versions that the tests ran with, of all that pyproject.toml names."""

import re

from packaging.utils import canonicalize_name

from benchmarks.publishing import constraints

LINES = [line for line in constraints.FILE.read_text("utf-8").splitlines() if not line.startswith("#")]


def test_each_line_is_a_package_and_its_version() -> None:
    """And no address of an index, of this computer or of a file."""
    assert [line for line in LINES if not re.fullmatch(r"[a-z0-9-]+==[0-9][0-9a-z.!]*", line)] == []
    assert sorted(LINES, key=lambda line: line.split("==")) == LINES
    assert "://" not in constraints.FILE.read_text("utf-8")


def test_all_that_is_declared_is_there_in_a_version_that_is_asked_for() -> None:
    known = dict(line.split("==") for line in LINES)
    untested = {"kaleido", "pyarrow", "tabulate"}  # which the extra `test` leaves out
    for wanted in (each for each in constraints.declared() if each.name not in untested):
        assert wanted.specifier.contains(known[canonicalize_name(wanted.name)], prereleases=True), wanted
    assert {"annotated-doc", "llvmlite", "pydantic-core"} & known.keys(), "none that those need in turn"
