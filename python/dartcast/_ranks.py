"""Processes that share a run: ranks, and those of mpi4py."""
from __future__ import annotations

import abc
from typing import Any, Optional

import numpy
import numpy.typing

from ._core import RankFailed

_Sums = numpy.typing.NDArray[numpy.uint64]


class Ranks(abc.ABC):
    """Processes that share a run, numbered from 0: their ranks. mpi_ranks() makes those of MPI.

    Every function is collective: all ranks call the same functions in the same order, and each call waits for the
    others. A rank that cannot go on calls fail(): then the next call of the others raises RankFailed.
    """

    @property
    @abc.abstractmethod
    def rank(self) -> int:
        """The number of this process."""

    @property
    @abc.abstractmethod
    def size(self) -> int:
        """The number of processes."""

    @abc.abstractmethod
    def gather(self, data: bytes) -> list[bytes]:
        """The first rank gets the bytes of each, by rank; the others get an empty list."""

    @abc.abstractmethod
    def broadcast(self, data: bytes) -> bytes:
        """All get the bytes of the first rank."""

    @abc.abstractmethod
    def exchange(self, data: list[bytes]) -> list[bytes]:
        """Each gives bytes for every rank, and gets theirs for it, by rank."""

    @abc.abstractmethod
    def sum(self, values: _Sums) -> _Sums:
        """The sums of the values of all ranks, modulo 2^64."""

    @abc.abstractmethod
    def fail(self, why: str) -> bool:
        """Says to the others that this rank has failed. Whether it is the first that has: it alone should print why."""


class _Mpi4pyRanks(Ranks):
    """Every call begins with the lowest rank that has failed, as in src/distributed/mpi_ranks.cpp."""

    def __init__(self, communicator: Any) -> None:
        from mpi4py import MPI
        self._mpi = MPI
        self._comm = (MPI.COMM_WORLD if communicator is None else communicator).Dup()

    @property
    def rank(self) -> int:
        return int(self._comm.Get_rank())

    @property
    def size(self) -> int:
        return int(self._comm.Get_size())

    def _check_failures(self) -> None:
        first = self._comm.allreduce(self.size, op=self._mpi.MIN)
        if first < self.size:
            raise RankFailed(f"rank {first}: {self._comm.bcast(None, root=first)}")

    def gather(self, data: bytes) -> list[bytes]:
        self._check_failures()
        return self._comm.gather(data, root=0) or []

    def broadcast(self, data: bytes) -> bytes:
        self._check_failures()
        return bytes(self._comm.bcast(data, root=0))

    def exchange(self, data: list[bytes]) -> list[bytes]:
        self._check_failures()
        return list(self._comm.alltoall(data))

    def sum(self, values: _Sums) -> _Sums:
        self._check_failures()
        sums = numpy.empty_like(values)
        self._comm.Allreduce(values, sums, op=self._mpi.SUM)
        return sums

    def fail(self, why: str) -> bool:
        first = self._comm.allreduce(self.rank, op=self._mpi.MIN)
        self._comm.bcast(why, root=first)
        return bool(first == self.rank)


def mpi_ranks(communicator: Optional[Any] = None) -> Ranks:
    """The processes of a communicator of mpi4py; None: all. It is duplicated, so that other messages do not come in between.
    Collective. Raises ImportError where mpi4py is not installed.
    """
    return _Mpi4pyRanks(communicator)
