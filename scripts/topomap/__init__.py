"""topomap: exact topological map-building in answer set programming.

The theory is in ``encodings/``; this package makes experiences, calls the solver,
searches without it, reads answers, checks and compares them.

==================  =====================================================
``topology``        maps: gateways, links, paths, faces, genus
``environment``     worlds to explore: grids, tori, mazes, lattices
``network``         worlds read from street and corridor networks
``route``           explorations of a world: snake, letters, walk, tour
``experience``      what an exploration shows; instance files
``validate``        all that is wrong with an instance, and what looks so
``generate``        one record from which name, header and facts come
``solver``          clingo on the encodings: enumeration, optimal maps
``phases``          large maps: what is certain first, by small programs
``plane``           planarity as clauses, added where two ways cross
``hypothesis``      a node of the paper's search tree, entered and undone
``search``          the tree breadth-first, depth-first, best-first: the second way
``branching``       the paper's equation (1), node by node
``share``           work shared out among those who do it
``processes``       processes of this machine
``cluster``         the workers of a Dask cluster
``statistics``      the figures of the search tree, by clingo and by search
``figure4``         the paper's table beside ours
``beyond``          what is beyond the paper's table
``check``           two checkers of maps: check.lp, and one by definition
``maps``            maps that anyone made: read, and judged
``journal``         long runs go on where they were cut
``formats``         what all JSON has in common: its format, and whether it is whole
``report``          maps as JSON, and as lines to read
``statements``      statements about maps, as ask and explain take them
``ask``             whether they hold in all maps, in some or in none
``explain``         why a statement cannot be: reasons none of which can be spared
``reasons``         the same in words, spelled out from a map
``explore``         the walk that tells maps apart; proofs that there is none
``bisimulation``    a checker of such proofs
``exploring``       what the subcommand ``explore`` does
``online``          explorations as they happen: multi-shot clingo, step by step
``following``       what the subcommand ``follow`` does
``simulate``        robots that map a world by this alone
``simulating``      what the subcommand ``simulate`` does
``scenes``          maps to be shown: of an instance, or from a file
``layout``          where places, links and pending gateways are drawn
``planarize``       a planar part of a map, and ways for the other links
``bent``           drawings with bent lines
``draw``            pictures of maps
``figures``         the paper's figures, from computed answers
``terminal``        maps in the lines of a terminal, and in words
``exports``         maps for other tools: GraphML, JSON, DOT, clingraph
``replay``          explorations step by step: what to show, what was refused
``words``           explorations in words
``svg``             small pictures for a page
``page``            the page of an exploration (page.html, page.css, page.js)
``family``          files that list the instances of a batch
``nx``              networkx, loaded where it is first used
``files``           inputs within a limit; outputs that are whole or not there
``commands``        what each subcommand does
``pictures``        the same of those that draw
``cli``             the command ``topomap``: arguments, help, exit status
==================  =====================================================
"""

__version__ = "0.2.0"
