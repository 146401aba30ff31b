"""The processor time that a task may take, so that every run ends."""

from time import perf_counter, process_time

from .engine import Failure, Status


class ProcessorBudget:
    """What one task may take of the process's processor time, which a busy machine does not use up."""

    def __init__(self, seconds: float, task: str) -> None:
        """Start the clock: so many seconds from now on, for a task as the reason names it, while it goes on."""
        self.seconds, self.task = seconds, task
        self._end, self._least = process_time() + seconds, perf_counter() + seconds

    def check(self, progress: str) -> None:
        """Do nothing while there is time left; then raise Failure, `timed_out`, with the task and its progress.

        Asking for the processor time can take longer than a step. It is no more than the time on the wall, but in a
        process of several threads, so it is asked for only when that is over.
        """
        if perf_counter() >= self._least and process_time() >= self._end:
            reason = f"{self.seconds:g} s of processor time were not enough for {self.task}: {progress}"
            raise Failure(Status.timed_out, reason)
