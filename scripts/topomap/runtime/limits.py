"""What the options of the command, and the arguments of the public functions, may be. It is apart
from what does the work, so that help and a mistyped call need not wait until the solver is
loaded."""

LARGEST = 2**31 - 1  # what clingo's numbers hold
DRIFT, STRETCH = 10, 10  # percent that shifts and lengths may be wrong by, unless told
MOST_PLACES = MOST_STEPS = 10**5  # of an environment, and of an exploration
MOST_WALKED = 1000  # steps of a further walk that `explore` may look for
LONGEST_WALK = 30  # steps of a further walk that `explore` looks for, unless told
MOST_COUNTED = 40_000  # hypotheses that `follow` counts, unless told
EXPORTS = ("graphml", "json", "dot", "clingraph", "tmap2")
DRAWING = 5.0  # seconds that a drawing takes at most, about, unless told
