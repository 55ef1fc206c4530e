"""networkx, which is loaded where it is first used, because that takes as long as all else."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from networkx import *  # noqa: F403
else:

    def __getattr__(name: str) -> Any:
        import networkx

        return getattr(networkx, name)
