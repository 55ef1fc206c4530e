"""How a command prints the reply of a public function."""

import argparse
from typing import IO, TYPE_CHECKING

from topomap.runtime import formats
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.model.reply import Reply


def tell(
    args: argparse.Namespace,
    out: IO[str],
    reply: "Reply",
    yes: bool,
    instance: str | None = None,
) -> int:
    """Write a reply as text or as JSON, and return the exit status.

    JSON names the instance that the reply is about, if there is one. The status is partial, or
    tells whether the answer is ``yes``.
    """
    if args.json:
        named = {} if instance is None else {"instance": instance}
        out.write(formats.line({**named, **reply.document()}, reply.fault))
    else:
        out.writelines(f"{line}\n" for line in reply.lines())
    return exit_status(reply.fault, yes)
