"""The subcommands, and what each is for, in the order of the help."""

SUBCOMMANDS = {
    "generate": "explore an environment and write what is seen as an instance",
    "log": (
        "read a log with bearings in degrees or compass letters, which is a table (CSV) or JSON "
        "lines, and write it as an instance"
    ),
    "validate": (
        "report all that is wrong with instances, and what looks like a mistake, without "
        "solving anything; the status is 2 if one of them has a fault (a warning is not a "
        "fault)"
    ),
    "solve": "enumerate the maps that are consistent with an exploration",
    "ask": (
        "say for each statement whether it holds in all maps that are consistent with an "
        "exploration, in some or in none, with maps as witnesses"
    ),
    "explain": (
        "say why a statement about the maps is impossible, or certain, or why there is no map, "
        "by reasons each of which is needed. (The statement is about all maps, not only the "
        "optimal ones, because a better map is not such a reason)"
    ),
    "explore": (
        "say where to go next: the shortest further walk that tells the maps apart, or leaves "
        "the fewest of them in the worst case; if there is no such walk, one to a pending "
        "gateway; or the proof that no walk can ever tell the maps apart"
    ),
    "follow": (
        "follow an exploration as it happens, and print after each step how many hypotheses"
        " there are, the best maps, what has become certain, and what to do next"
    ),
    "simulate": (
        "let a robot explore an environment that it does not know, until it has one closed "
        "optimal map, and compare this map with the real one"
    ),
    "atlas": (
        "count how many maps explain each step of a tour and of a random walk in several worlds, "
        "say which further walk leaves only the real map and whether minimality prefers it, and "
        "write this as a page or as JSON"
    ),
    "count": "count the search tree of an exploration, as the paper's Figure 4 does",
    "search": "search the tree of an exploration without clingo, as the paper does",
    "branching": (
        "check the paper's equation (1), bp/b = (pi / mean p) / (m + 1), at every branching"
        " node of the planar tree"
    ),
    "check": (
        "check maps from any source by encodings/check.lp and by a second checker (a "
        "time limit ends the check between two maps)"
    ),
    "table": "print the paper's Figure 4 beside our numbers, and write them as JSON",
    "family": (
        "print the names of the instances of a family file, and write the arguments of those "
        "that changed"
    ),
    "draw": "draw a map, as SVG, PNG or PDF",
    "show": "print a map, drawn in the terminal and then described in words",
    "report": (
        "write one page about explorations, to be opened in a browser: the log, how many "
        "hypotheses there are, what was refused, the best maps, and a replay step by step; "
        "the page marks what could not be counted or drawn within --timeout (default: 60)"
    ),
    "figures": "draw the paper's figures and some more, from computed answers",
    "export": (
        "write a map for other tools: GraphML, JSON (node-link), DOT, facts for clingraph, tmap2"
    ),
    "import": "read a map that export wrote, and write it as solve --json does",
    "path": "print the folder of the encodings, for clingo, or that of the instances",
    "clingo": "run clingo itself, with its options and exit statuses",
}
