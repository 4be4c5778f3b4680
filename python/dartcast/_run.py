"""Scenes from files and dicts, and runs of them."""
from __future__ import annotations

import contextlib
import enum
import json
import os
import pathlib
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Optional, Union

import numpy

from . import _core
from ._ranks import Ranks

Progress = Callable[[int, int], Optional[bool]]
SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any], _core.Scene]


def _text(value: str) -> str:
    """A text of TOML, as a value or a key."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any, where: str) -> str:
    """A value in TOML, on one line."""
    if isinstance(value, numpy.ndarray):
        value = value.tolist()
    elif isinstance(value, numpy.generic):
        value = value.item()
    if isinstance(value, enum.Enum):
        value = value.name.lower()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return _text(os.fspath(value))
    if isinstance(value, Mapping):
        entries = (f"{_text(key)} = {_value(entry, f'{where}.{key}')}"
                   for key, entry in value.items() if entry is not None)
        return "{" + ", ".join(entries) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(entry, f"{where}[{i}]") for i, entry in enumerate(value)) + "]"
    raise TypeError(f"{where}: expected a number, a bool, a text, a list or a dict; got a {type(value).__name__}")


def scene_text(scene: Mapping[str, Any]) -> str:
    """A dict with the keys of docs/scene.md as the text of a scene file, a line for each key. None: the key is left out.

    Raises TypeError, which names the key, where a value is of no type that TOML has.
    """
    return "".join(f"{_text(key)} = {_value(value, key)}\n" for key, value in scene.items() if value is not None)


def load_scene(scene: SceneLike, *, threads: int = 0) -> _core.Scene:
    """A scene for Simulation(): from a .toml file, a dict with the keys of docs/scene.md, or a Scene. The files that it
    names are read. Relative paths are taken from the folder of the file, or from the current one.

    Raises as parse_scene() and load_scene_files().
    """
    return _core.load_scene_files(_plain(scene), threads=threads).scene


def _plain(scene: SceneLike) -> _core.Scene:
    if isinstance(scene, _core.Scene):
        return scene
    if isinstance(scene, Mapping):
        return _core.parse_scene(scene_text(scene), pathlib.Path("scene.toml"))
    return _core.read_scene(pathlib.Path(scene))


Stage = Callable[[str], None]


@contextlib.contextmanager
def _shown(progress: Union[bool, Progress, None]) -> Iterator[tuple[Optional[Progress], Optional[Stage]]]:
    """The functions for run_scene(): that of the caller, or those that move a bar and say what comes before it."""
    if progress is not True:
        yield None if progress is False else progress, None
        return
    with warnings.catch_warnings():  # tqdm warns in notebooks that have no widgets, and shows a text
        warnings.simplefilter("ignore")
        try:
            from tqdm.auto import tqdm
        except ImportError:
            tqdm = None
    bar, last = tqdm(unit="step") if tqdm else None, 0.0

    def show(done: int, all_: int) -> None:
        nonlocal last
        if bar is not None:
            bar.total = all_
            if bar.desc:
                bar.set_description(refresh=False)
            bar.update(done - bar.n)
        elif done == all_ or time.monotonic() - last > 0.2:
            last = time.monotonic()
            print(f"\r{done:,} of {all_:,} steps ({done / all_:.0%})\x1b[K", end="", file=sys.stderr, flush=True)

    def enter(stage: str) -> None:
        if bar is not None:
            bar.set_description(stage)
        else:
            print(f"\r{stage}\x1b[K", end="", file=sys.stderr, flush=True)
    try:
        yield show, enter
    finally:
        print(file=sys.stderr) if bar is None else bar.close()


def run(scene: SceneLike, out: Union[str, "os.PathLike[str]", None] = None, *, threads: int = 0,
        steps: Optional[int] = None, seed: Optional[int] = None, audit: bool = False, resume: bool = False,
        skip_bad_cells: bool = False, progress: Union[bool, Progress, None] = None,
        max_memory: int = 0, ranks: Optional[Ranks] = None, partition: str = "particles") -> _core.Summary:
    """Runs a scene: a .toml file, a dict with the keys of docs/scene.md, or a Scene.

    out: the folder for frames and summary.json; None: nothing is written. The other arguments are those of RunOptions.
    progress: a function as in run_scene(); True: a bar of tqdm, or a line on stderr if tqdm is missing, which also says
    what is done before the first step. Ctrl-C ends the run between two steps, and resume=True goes on from there. ranks: the
    processes that share the run, as mpi_ranks(); all call run() with the same arguments, and the first returns the
    summary of all. partition: "particles" or "cells". Raises as run_scene().
    """
    options = _core.RunOptions(threads=threads, steps=steps, seed=seed, audit=audit, resume=resume,
                               skip_bad_cells=skip_bad_cells, max_memory=max_memory, partition=partition)
    if out is not None:
        options.folder = pathlib.Path(out)
    with _shown(progress) as (show, enter):
        return _core.run_scene(_plain(scene), options, show, ranks, enter)
