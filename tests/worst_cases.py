"""What a worker process can be asked to do; at the top of a module of its own, so that it can be sent there."""

import os
import signal
import time


def do(what: str) -> str:
    if what == "abort":
        os.abort()
    if what == "segfault":
        os.kill(os.getpid(), signal.SIGSEGV)
    if what == "exit":
        os._exit(3)
    if what == "hang":
        time.sleep(600)
    while what == "spin":
        pass
    if what == "eat":
        return str(len(bytearray(64 * 2**30)))
    if what == "raise":
        raise ValueError("first line\nsecond line")
    return what.upper()
