"""Processes of their own for engines: `inside` begins and limits them, `messages` is their answers, `guard` ends them.

This process has `isolation`, one process, or several for items of one kind; `workers`, one an engine; `cluster`, those
of many machines; `stopping`, Ctrl-C.
"""
