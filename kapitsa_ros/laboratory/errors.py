"""Errors of the laboratory without the graph."""

from kapitsa_ros.errors import FAILED, KapitsaError


class ClusterError(KapitsaError):
    """A cluster cannot be used; the message says how to correct it."""

    exit_status = FAILED


class DiskError(KapitsaError):
    """The disk does not take the outcomes of a campaign; those that it has taken stay."""

    exit_status = FAILED


class WorkerLostError(KapitsaError):
    """A process of this machine that computed was killed."""

    exit_status = FAILED
