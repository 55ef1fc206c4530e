"""The subcommand ``generate``."""

import argparse
import contextlib
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import (
    Parser,
    add_environments,
    add_senses,
    add_start,
    command,
    number,
)
from topomap.cli.calls import environment_of
from topomap.runtime import formats
from topomap.runtime.errors import InputError, say
from topomap.runtime.files import output
from topomap.runtime.limits import MOST_STEPS
from topomap.runtime.status import DONE

if TYPE_CHECKING:
    from topomap.worlds.environment import Environment
    from topomap.worlds.instance import Instance


def add(group: Any) -> None:
    """The parser of ``topomap generate``."""
    made = command(
        group,
        "generate",
        """\
  topomap generate grid 3 4 --route snake -o grid-3x4-snake.lp
  topomap generate torus 3 3 --route walk --steps 20 --seed 1
  topomap generate crescents 2 4 --route tour
  topomap generate grid 4 4 --route snake --compass --odometry 5 --seed 1
  topomap generate grid 4 4 --route snake --world grid.graphml
  topomap generate world city.graphml --slots 4 --north 29 --route tour --signs 0.3""",
    )
    common = Parser(add_help=False)
    add = common.add_argument
    add(
        "--route",
        required=True,
        metavar="ROUTE",
        help="snake; walk (random); tour (over every way); compass letters such as ESSENN "
        "(4 slots; with 8, separated by commas: N,NE,E); or absolute slots: 0,3,1",
    )
    add(
        "--steps",
        type=number(int, 0, MOST_STEPS),
        metavar="N",
        help="cut the route after N steps; a walk needs it (default: the whole route)",
    )
    add_start(add, "the one by which the route leaves")
    add(
        "--seed",
        type=number(int, 0),
        metavar="N",
        help="seed for walk, signs, maze and odometry (default: 0)",
    )
    add_senses(add)
    add("--name", help="name of the instance (default: made from the arguments)")
    add(
        "--truth",
        metavar="FILE",
        help="also write the true hypothesis, for solve --truth (default: not written)",
    )
    add(
        "--world",
        metavar="FILE",
        help="also write the world itself, with positions: as GraphML (.graphml), node-link JSON "
        "(.json) or tmap2 (.yaml), chosen by the extension of the name (default: not written)",
    )
    add("--json", action="store_true", help="print a summary as JSON")
    add("-o", "--output", metavar="FILE", help="file or folder to write (default: stdout)")
    add_environments(made, common, "--route tour")


def run(args: argparse.Namespace) -> int:
    """Explore an environment and write the instance."""
    from topomap.exchange.worlds import form_of, world_text
    from topomap.model.found import steps_json
    from topomap.worlds.census import census

    world = environment_of(args)
    known = census(world.map) if args.json or args.kind in ("world", "network") else None
    if known and not args.json:
        for line in known.lines():
            say(f"{world.name}: {line}")
    made = instance_of(args, world)
    if made.fault:
        fault = "the environment's own map breaks the path axiom"
        say(f"{made.name}: {fault}; only --no-path-axiom finds it")
    target = args.output
    if target and (target.endswith("/") or Path(target).is_dir()):
        target = str(Path(target) / f"{made.name}.lp")
    written = {"--output": target, "--truth": args.truth, "--world": args.world}
    for one, other in combinations([name for name, file in written.items() if file], 2):
        if Path(written[one]).resolve() == Path(written[other]).resolve():
            raise InputError(f"{written[one]}: it cannot be both {one} and {other}")
    signed = world if args.signs is None else world.signed(args.signs, args.seed or 0)
    text = world_text(signed, form_of(args.world)) if args.world else ""
    with contextlib.ExitStack() as files:
        if args.world:
            files.enter_context(output(args.world)).write(text)
        if args.truth:
            truth = formats.line({"maps": [{"at": steps_json(made.truth)}]})
            files.enter_context(output(args.truth)).write(truth)
        if target or not args.json:
            files.enter_context(output(target)).write(made.text())
    if args.json:
        summary = {
            "name": made.name,
            "file": target,
            "header": made.header,
            "steps": made.experience.steps,
            "world": known and known.document(),
            "facts": None if target else made.experience.facts(),
        }
        print(formats.line(summary), end="")
    return DONE


def instance_of(args: argparse.Namespace, world: "Environment | None" = None) -> "Instance":
    """Make the instance of a call of ``generate``, in a ``world`` if that was made before."""
    from topomap.api.generate import generate

    world = world or environment_of(args)
    if args.route == "walk" and args.steps is None:
        raise InputError("topomap generate: --route walk needs --steps")
    return generate(
        world,
        route=args.route,
        steps=args.steps,
        start=args.start,
        facing=args.facing,
        signs=args.signs,
        seed=args.seed,
        name=args.name,
        compass=args.compass,
        odometry=args.odometry,
        lengths=args.lengths,
    )
