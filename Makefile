# make            set up, make the instances, print the paper's table beside ours
# make test       run the tests that are quick; make test-long runs all tests (JOBS: processes)
# make mutate     change each rule in turn, and write docs/mutation.md (JOBS)
# make lint       check style and types
# make instances  make the batch that instances/batch.txt lists (try make -j2 instances)
# make bench      time the encodings and the search, write docs/benchmark.md, then what steps of
#                 follow, questions, the start, solve and long logs take,
#                 docs/{online,asking,start,solve,logs}.md (two hours;
#                 BENCH: options, such as BENCH='--only 8x8', BENCH=--quick, BENCH=--help)
# make docs       build the site of the pages, build/site (a minute)
# make figures    draw the pictures of the pages again, docs/figures/ and docs/gallery/
# make reasons    count the reasons of explain where there is no map, in docs/questions.md (minutes)
# make knowledge  count what a compass and odometry leave, docs/knowledge.md and its picture (an hour)
# make simulate   let robots explore 21 worlds, docs/simulations.json (seconds)
# make atlas      count how ambiguous walks in 22 worlds are, docs/atlas.json and docs/atlas.md
#                 (half an hour; it installs AALpy, which learns the same worlds)
# make circumscription   compare both readings of the preference, docs/circumscription.md
#                 (twenty minutes)
# make beyond     count what is beyond the paper's table, docs/beyond.json (an hour)
# make man        write the manual pages, build/man/topomap.1 and one for each subcommand
# make clean      remove what make made
# make committed  make the committed instances again (MAPS: folder of the real maps)

PYTHON  ?= python3
JOBS    ?= $(shell nproc)
MAPS    ?= ../shared/maps
BIN     := .venv/bin
SETUP   := .venv/set-up
TOOLS   := .venv/tools
PEERS   := .venv/peers
BATCH   := build/instances
MAKERS  := $(wildcard scripts/topomap/worlds/*.py scripts/topomap/worlds/readers/*.py) $(addprefix scripts/topomap/model/, \
             experience.py topology.py)
PIP     := $(BIN)/python -m pip --quiet --disable-pip-version-check

.PHONY: all table instances batch test test-long mutate lint docs figures bench beyond circumscription simulate \
        atlas knowledge reasons man clean \
        committed anew
.DELETE_ON_ERROR:

# One after the other, also under make -j, so that the table is printed last.
all: $(SETUP)
	@$(MAKE) --no-print-directory instances
	@$(MAKE) --no-print-directory table

# The environment knows the folder that it is in, and the Python that it was made of. It is made
# anew if either is another one (PYTHON counts if it was given), or if its Python is gone.
WHO     := import sys; print(sys.base_prefix, sys.version.split()[0])
GIVEN   := $(if $(filter file,$(origin PYTHON)),,yes)
CURRENT := $(shell { .venv/bin/python -c "" && test -e $(SETUP) && \
             test "$$(cd -P .venv && pwd)" = "$$(sed -n 1p $(SETUP))" && \
             { test -z "$(GIVEN)" || \
               test "$$($(PYTHON) -c '$(WHO)')" = "$$(sed -n 2p $(SETUP))"; } } 2>/dev/null && echo yes)
ifneq ($(CURRENT),yes)
$(SETUP): anew
endif

$(SETUP): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed: make PYTHON=...")'
	$(if $(CURRENT),,rm -rf .venv)
	$(PYTHON) -m venv .venv
	$(PIP) install --editable '.[draw]'
	$(BIN)/python -m compileall -q scripts/topomap  # so that the first call is as quick as later ones
	printf '#!/bin/sh\nexec "$$(dirname "$$0")/topomap" clingo "$$@"\n' >$(BIN)/clingo
	chmod +x $(BIN)/clingo
	(cd -P .venv && pwd && bin/python -c '$(WHO)') >$@

# What the tests and make lint need besides.
$(TOOLS): $(SETUP)
	$(PIP) install --editable '.[dev]'
	touch $@

# What make atlas compares with.
$(PEERS): $(SETUP)
	$(PIP) install --editable '.[peers]'
	touch $@

table: $(SETUP)
	$(BIN)/topomap table

# Each line of the family file becomes calls NAME.args, written only where a call, or the file
# that it reads, was changed.
instances: $(SETUP)
	$(BIN)/topomap family instances/batch.txt --directory $(BATCH) >/dev/null
	@$(MAKE) --no-print-directory batch

batch: $(patsubst %.args,%.lp,$(wildcard $(BATCH)/*.args))

# The shell reads the call: in names of files it may quote blanks, dollars and the like.
$(BATCH)/%.lp: $(BATCH)/%.args $(MAKERS)
	@echo "topomap generate $$(sed 1q '$<')"
	@eval "$(BIN)/topomap generate $$(sed 1q '$<') --output '$@'"

test: $(TOOLS)
	$(BIN)/pytest -n $(JOBS) -m 'not slow and not long'

test-long: $(TOOLS)
	$(BIN)/pytest -n $(JOBS) --tried results/tried.json

mutate: $(TOOLS)
	PYTHONPATH=tests $(BIN)/python -m oracles.rule_mutation --jobs $(JOBS) --known build/mutants.txt

lint: $(TOOLS)
	$(BIN)/ruff check scripts tests
	$(BIN)/ruff format --check scripts tests
	$(BIN)/mypy
	$(BIN)/lint-imports

GENERATE  := $(BIN)/topomap generate
MANHATTAN := world "$(MAPS)/manhattan.graphml" --slots 4 --north 29 --two-way --route tour

bench: $(TOOLS)
	PYTHONPATH=tests $(BIN)/python -m bench --networks "$(MAPS)" $(BENCH)
	PYTHONPATH=tests $(BIN)/python -m bench.online
	PYTHONPATH=tests $(BIN)/python -m bench.asking
	PYTHONPATH=tests $(BIN)/python -m bench.start
	PYTHONPATH=tests $(BIN)/python -m bench.ways --networks "$(MAPS)"
	PYTHONPATH=tests $(BIN)/python -m bench.logs

figures: $(SETUP)
	$(BIN)/topomap figures --directory docs/figures
	$(BIN)/python scripts/website/gallery.py

# The variable turns off a notice on the future of mkdocs. (With --quiet nothing would be strict.)
docs: $(TOOLS)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo 'build/site is made; to read and search it: $(BIN)/python -m http.server -d build/site'

circumscription: $(TOOLS)
	PYTHONPATH=tests $(BIN)/python -m bench.circumscription

beyond: $(SETUP)
	$(BIN)/topomap table --beyond --resume --output docs/beyond.json

knowledge: $(TOOLS)
	PYTHONPATH=tests $(BIN)/python -m bench.knowledge

reasons: $(TOOLS)
	PYTHONPATH=tests $(BIN)/python -m bench.reasons

simulate: $(SETUP)
	$(BIN)/topomap simulate list instances/worlds.txt --json --output docs/simulations.json

man: $(SETUP)
	$(BIN)/python -m topomap.cli.manual build/man

atlas: $(PEERS)
	$(BIN)/topomap atlas instances/atlas.txt --seconds 30 --json --output docs/atlas.json
	$(BIN)/topomap atlas --from docs/atlas.json --output docs/atlas.md

committed: $(SETUP)
	$(GENERATE) grid 3 3 --route snake -o instances/
	$(GENERATE) grid 3 4 --route ESSENNESSWWWNEEENWWWS --name grid-3x4-paper -o instances/
	$(GENERATE) grid 4 4 --route snake -o instances/
	$(GENERATE) grid 3 3 --route EESWWSEENNWSSWNNSSEN --name grid-3x3-misread \
	  | sed -e 's/^turn(13,.*/& view(13,2)./' \
	    -e 's/^% made by.*/&\n% and one gateway imagined: view(13,2) is added to what is seen there/' \
	  > instances/grid-3x3-misread.lp
	$(GENERATE) $(MANHATTAN) --steps 20 -o instances/
	$(GENERATE) $(MANHATTAN) --steps 40 --signs 0.3 -o instances/
	$(GENERATE) $(MANHATTAN) --signs 0.3 -o instances/

clean:
	rm -rf .venv build results .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find scripts tests -name __pycache__ -prune -exec rm -rf {} +
	rm -rf scripts/*.egg-info
