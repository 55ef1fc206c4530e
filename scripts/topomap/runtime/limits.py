"""The bounds of the options of the command and of the arguments of the public functions.

They are separate from what does the work, so that help, and the message about a mistyped call, need
not wait for the solver.
"""

LARGEST = 2**31 - 1  # the largest number of clingo
DRIFT, STRETCH = 10, 10  # defaults in percent: how wrong shifts and lengths may be
MOST_PLACES = MOST_STEPS = 10**5  # of an environment and of an exploration
MOST_WALKED = 1000  # steps: the largest bound for the further walk of `explore`
LONGEST_WALK = 30  # steps: the default of that bound
MOST_COUNTED = 40_000  # hypotheses: the default of what `follow` counts
EXPORTS = ("graphml", "json", "dot", "clingraph", "tmap2")
DRAWING = 5.0  # seconds: the default time limit of a drawing
