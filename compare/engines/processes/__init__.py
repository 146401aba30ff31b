"""Processes of their own for engines: `inside` is what goes on in one, from its begin by a guard to its answers.

This process has `isolation`, one process, or several for items of one kind; `workers`, one an engine; `cluster`, those
of many machines; `stopping`, Ctrl-C.
"""
