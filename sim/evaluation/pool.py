"""Many jobs on all cores of this computer, or on a cluster: joblib does both."""

import contextlib

import joblib

from sim.evaluation.jobs import code_digest, run_job

__all__ = ["ClusterError", "run_jobs"]


_PATIENCE_S = 10
"""Seconds in which a scheduler must answer."""


class ClusterError(RuntimeError):
    """The cluster cannot be used; the message says why."""


def _numbered(number, job):
    return number, run_job(job)


def _workers_digest():
    """What a worker has of this project, or what it says instead."""
    try:
        from sim.evaluation.jobs import code_digest as digest
    except ImportError as error:
        return str(error)
    return digest()


@contextlib.contextmanager
def _cluster(address):
    """joblib's work goes to a Dask scheduler."""
    if address is None:
        yield
        return
    from distributed import Client

    try:
        client = Client(address, timeout=_PATIENCE_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        digests = client.run(_workers_digest)
        if not digests:
            raise ClusterError(f"the Dask scheduler at {address} has no workers")
        for worker, digest in digests.items():
            if digest != code_digest():
                raise ClusterError(
                    f"the Dask worker {worker} does not have these sources ({digest}): start it in this checkout"
                )
        with joblib.parallel_config(backend="dask", client=client):
            yield


def run_jobs(jobs, store, *, workers=-1, dask=None, progress=lambda items, description, total: items, title="jobs"):
    """Results of jobs, in their order; those that the store has are taken from there, the others put into it.

    Parameters
    ----------
    jobs : list of Job
    store : Store
    workers : int
        Processes; -1 is one for each core. A cluster has its own.
    dask : str or None
        Address of a Dask scheduler.
    progress : callable
        ``progress(items, description, total)`` yields the items.

    Raises
    ------
    ClusterError
        The cluster does not answer, has no workers, or they have other sources.
    """
    missing = [number for number, job in enumerate(jobs) if not store.has(job)]
    if missing:
        with _cluster(dask):
            pool = joblib.Parallel(n_jobs=workers, return_as="generator_unordered")
            done = pool(joblib.delayed(_numbered)(number, jobs[number]) for number in missing)
            for number, result in progress(done, title, len(missing)):
                store.put(jobs[number], result)
    return [store.get(job) for job in jobs]
