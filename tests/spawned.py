"""Processes begun anew instead of forked, as off Linux: `python -m tests.spawned` prints what came of each item.

They import this module too. The last item never ends: the number of its process is printed until this one is killed.
"""

from multiprocessing import get_context

from compare.engines.processes import inside, isolation
from compare.engines.processes.inside import Ended, Limits
from compare.engines.processes.isolation import Worker
from tests.deaths import children, do

vars(inside)["LINUX"] = vars(isolation)["LINUX"] = False
isolation.CONTEXT = get_context("spawn")


def main() -> None:
    """Ask one process three times, which ends it, then another two."""
    workers = [Worker[str, str](do) for _ in range(3)]
    for number, what, seconds in ((0, "a", 60.0), (0, "SystemExit", 60.0), (0, "asleep", 0.1), (1, "abort", 60.0)):
        workers[number].ask(what, Limits(seconds))
        outcome = workers[number].wait(lambda: None)
        print(what, outcome.reason if isinstance(outcome, Ended) else outcome, sep=": ", flush=True)
    workers[2].ask("asleep", Limits(60.0))
    workers[2].wait(lambda: print(*children(), flush=True))


if __name__ == "__main__":
    main()
