"""The pytest plug-in: a scene file is a test for each engine and channel group, and one of the comparison itself.

It is imported by pytest in every project of an environment, where `compare` and `scenes` may be the project's own: of
this package nothing is imported before a scene file is collected, or the fixture asked for.
"""

import re
import warnings
from collections.abc import Callable, Iterator
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from argparse import Namespace

    from compare.judge.agreement import Judgement
    from compare.report.notebook import CheckResult
    from scenes import Scene

ENGINES, SAMPLES = "analytic,exudyn,pymunk", "360"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take the options of the command line and of the configuration file."""
    group = parser.getgroup("linkage", "scene files of linkages")
    group.addoption("--linkage-engines", metavar="A,B", default=ENGINES, help=f"engines that solve them ({ENGINES})")
    group.addoption("--linkage-samples", metavar="N", default=SAMPLES, help=f"samples a cycle of the drive ({SAMPLES})")
    parser.addini("linkage_scenes", "patterns of scene files to collect where they are not named", type="args")


def pytest_load_initial_conftests(early_config: pytest.Config, args: list[str]) -> None:
    """Take the option and fixtures of the engines' contract, where that is what is asked for."""
    if any(re.match(r"compare\.contract(\.test_|::|$)", argument) for argument in args):
        early_config.pluginmanager.import_plugin("compare.contract.asked")


def pytest_configure(config: pytest.Config) -> None:
    """Name the marker of the tests."""
    config.addinivalue_line("markers", "linkage: a test of a scene file")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "SceneFile | None":
    """Collect a scene file that is named on the command line, or matches a pattern of the configuration."""
    if file_path.suffix != ".toml" or file_path.name == "pyproject.toml":
        return None
    config = parent.config
    start = config.invocation_params.dir  # pytest itself forgets a file that is named beside a folder that has it
    named = any(file_path.resolve() == (start / argument.partition("::")[0]).resolve() for argument in config.args)
    if named or any(file_path.match(pattern) for pattern in config.getini("linkage_scenes")):
        return SceneFile.from_parent(parent, path=file_path)
    return None


@pytest.fixture(scope="session")
def linkage_check(pytestconfig: pytest.Config) -> "Callable[..., CheckResult]":
    """Return `compare.check`, with the engines and samples of the command line; bad input fails a test in one line."""

    def check(scene: "Scene | str | Path", **arguments: Any) -> "CheckResult":
        _check_names()
        from compare import check
        from scenes import InputError

        try:
            asked = _asked(pytestconfig)
            return check(scene, **({"engines": asked.engines, "samples": asked.samples} | arguments))
        except InputError as error:
            pytest.fail(str(error), pytrace=False)

    return check


def _asked(config: pytest.Config) -> "Namespace":
    from compare.cli.arguments import parser

    option = config.option
    return parser().parse_args([f"--engines={option.linkage_engines}", f"--samples={option.linkage_samples}"])


class SceneFile(pytest.File):
    """The tests of one scene, which is solved once."""

    scene: "Scene"
    options: "Namespace"

    def collect(self) -> Iterator["ChannelGroup"]:
        """Yield a test for each engine and channel group, then that of the comparison; bad input is named in a line."""
        _check_names()
        from compare.judge.errors import shown_groups
        from scenes import InputError, load

        try:
            self.scene, self.options = load(self.path), _asked(self.config)
        except InputError as error:
            raise self.CollectError(str(error).partition("; usage: ")[0]) from None
        self.add_marker("linkage")
        for engine in self.options.engines:
            for group in dict.fromkeys((*shown_groups(self.scene), "drive", *self.scene.tolerances.get(engine, ()))):
                yield ChannelGroup.from_parent(self, name=f"{engine}[{group}]")
        yield ChannelGroup.from_parent(self, name="comparison")

    @cached_property
    def judgement(self) -> "Judgement | str":
        """The scene as judged, or in one line why it cannot be."""
        from compare.cli.arguments import sampling
        from compare.study import judged
        from scenes import InputError

        with warnings.catch_warnings():  # a fork uses no other thread, as pytest-xdist has
            warnings.filterwarnings("ignore", "This process .* is multi-threaded", DeprecationWarning)
            try:
                return judged(self.scene, self.options.engines, sampling(self.scene, self.options.samples, 1))
            except InputError as error:
                return str(error)


class ChannelGroup(pytest.Item):
    """The test that an engine keeps its promise, and the scene's tolerance, in a channel group; or of all else."""

    parent: SceneFile

    def runtest(self) -> None:
        """Fail in the lines by which `compare.run --check` names it; a tolerance that is not held is skipped."""
        judgement = self.parent.judgement
        if lines := [*self._trouble(judgement)]:
            pytest.fail("\n".join(lines), pytrace=False)
        for gate in () if isinstance(judgement, str) else judgement.held:
            if not gate.held and (gate.engine, gate.group) == self._names:
                pytest.skip(f"not held: {gate}")

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Return the file, the line of the tolerance, from 0, and the name of the test in reports."""
        from compare.ci.github import line_of

        line = line_of(self.path, ("tolerances", *self._names))
        return self.path, line and line - 1, f"{self.path.name} {self.name}"

    @property
    def _names(self) -> tuple[str, str]:
        engine, _, group = self.name.removesuffix("]").partition("[")
        return engine, group

    def _trouble(self, judgement: "Judgement | str") -> Iterator[str]:
        if isinstance(judgement, str):
            yield judgement
            return
        engine, group = self._names
        # The item "comparison" stands for what belongs to no engine that was judged.
        if engine not in judgement.verdicts:
            yield from (miss.text for miss in judgement.misses if miss.engine not in judgement.verdicts)
            return
        status, reason = judgement.verdicts[engine]
        lines = [miss.text for miss in judgement.misses if miss.engine == engine and miss.group in ("", group)]
        if lines or status != "ok":
            yield from lines or [f"{engine}: {status}: {reason}"]
            if engine in judgement.causes:
                yield f"likely cause: {judgement.causes[engine]}"


def _check_names() -> None:
    """Fail in one line where a module of the project has the name of one that is needed."""
    # `find_spec` finds where a package would come from and runs nothing of it: a project that has a `compare` of its
    # own is told so before that is imported in place of this one.
    home = Path(__file__).parents[1]
    for name in ("analytic", "compare", "scenes", "sim_models"):
        spec = find_spec(name)
        if spec is None or spec.origin is None or Path(spec.origin).parents[1] != home:
            other = spec and spec.origin
            pytest.fail(f"linkage-crosscheck: '{name}' is expected to be its own, found {other}", pytrace=False)
