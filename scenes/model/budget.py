"""The processor time that a task may take, so that every run ends."""

from time import perf_counter, process_time

from .engine import Failure, Status


class ProcessorBudget:
    """What one task may take of the process's processor time, which a busy machine does not use up."""

    def __init__(self, seconds: float, task: str) -> None:
        """Start the clock.

        Args:
            seconds: the processor time from now on, s.
            task: what it is for, as the reason names it; it may be renamed while it goes on.
        """
        self.seconds, self.task = seconds, task
        self._end, self._least = process_time() + seconds, perf_counter() + seconds

    def check(self, progress: str) -> None:
        """Do nothing while there is time left; cheap enough for every step of the task.

        Asking for the processor time can take longer than a step. It is no more than the time on the wall, but in a
        process of several threads, so it is asked for only when that is over.

        Args:
            progress: how far the task has come, in a few words.

        Raises:
            Failure: `timed_out`, the reason names the task and its progress.
        """
        if perf_counter() >= self._least and process_time() >= self._end:
            reason = f"{self.seconds:g} s of processor time were not enough for {self.task}: {progress}"
            raise Failure(Status.timed_out, reason)
