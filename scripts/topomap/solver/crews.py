"""The crews that do the work."""

from topomap.solver.share import ALONE, Crew


def crew(jobs: int = 1, dask: str | None = None) -> Crew:
    """Make a crew: the workers of the Dask cluster at an address, or so many processes."""
    # What shares work is loaded only if it is asked for; a single process does not need it.
    if dask is not None:
        from topomap.solver.cluster import Cluster

        return Cluster(dask)
    if jobs > 1:
        from topomap.solver.processes import Processes

        return Processes(jobs)
    return ALONE
