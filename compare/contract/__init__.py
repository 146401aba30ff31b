"""What every engine keeps to, as tests that its author runs: `pytest --pyargs compare.contract --engine NAME`.

| file | clauses |
|---|---|
| `test_protocol.py` | names, settings and their labels, promises |
| `test_motion.py` | on every shipped scene: status, channels, units and signs by the promise, instants, determinism |
| `test_refusals.py` | what an engine cannot do, and what cannot be done, is a status with a reason |
| `test_process.py` | nothing imported at registration, nothing printed, no file left, the same in another process |

Each test is a clause, its docstring what is asked. `-k four_bar` takes the clauses of one scene.
"""
