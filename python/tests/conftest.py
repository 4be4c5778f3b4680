"""What all tests of the package share."""
from __future__ import annotations

import gc
import os
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


@pytest.fixture
def root() -> pathlib.Path:
    """The project's folder."""
    return ROOT


@pytest.fixture
def scenes(root: pathlib.Path) -> pathlib.Path:
    return root / "scenes"


def full() -> bool:
    """Whether the tests run at full size (./dev test --full)."""
    return os.environ.get("DARTCAST_FULL") == "1"


def pytest_collection_finish() -> None:
    """What all tests import needs no more searching: it took half of their time."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def _collected() -> None:
    """Objects of one test do not live on in the next."""
    gc.collect()
