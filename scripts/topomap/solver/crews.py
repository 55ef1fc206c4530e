"""Who is there to do the work."""

from topomap.solver.share import ALONE, Crew


def crew(jobs: int = 1, dask: str | None = None) -> Crew:
    """The workers of the Dask cluster at that address, or so many processes."""
    # What shares work out is loaded where it is asked for: one process needs none of it.
    if dask is not None:
        from topomap.solver.cluster import Cluster

        return Cluster(dask)
    if jobs > 1:
        from topomap.solver.processes import Processes

        return Processes(jobs)
    return ALONE
