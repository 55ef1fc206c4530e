"""``make bench``: what each way takes for the same answers, and how that grows.

==============  ===========================================================
``rows.toml``   the tasks, the expected answers, the goals
``reference``   .toml: figures of others for the same tasks
``rows``        reads rows.toml
``task``        one measurement, in a process of its own: the ways
``measure``     rows by ways: repetitions, limits, verdicts, ratios
``growth``      curves: exponents, and the picture
``online``      what a step costs a follower; docs/online.md, a command of its own
``memory``      memory while very many maps go to a file
``report``      docs/benchmark.md
``__main__``    the command
==============  ===========================================================

The process that starts the measurements loads neither clingo nor the package: what it has
in memory would count as its children's.
"""
