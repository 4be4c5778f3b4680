"""Scenes from files and dicts, and runs of them."""
from __future__ import annotations

import enum
import json
import os
import pathlib
from collections.abc import Callable, Mapping
from typing import Any, Optional, Union

import numpy

from . import _core
from ._ranks import Ranks

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


def run(scene: SceneLike, out: Union[str, "os.PathLike[str]", None] = None, *, threads: int = 0,
        steps: Optional[int] = None, seed: Optional[int] = None, audit: bool = False, resume: bool = False,
        skip_bad_cells: bool = False, progress: Optional[Callable[[int, int], Optional[bool]]] = None,
        max_memory: int = 0, ranks: Optional[Ranks] = None, partition: str = "particles") -> _core.Summary:
    """Runs a scene: a .toml file, a dict with the keys of docs/scene.md, or a Scene.

    out: the folder for frames and summary.json; None: nothing is written. The other arguments are those of RunOptions.
    progress: see run_scene(). Ctrl-C ends the run between two steps, and resume=True goes on from there. ranks: the
    processes that share the run, as mpi_ranks(); all call run() with the same arguments, and the first returns the
    summary of all. partition: "particles" or "cells". Raises as run_scene().
    """
    options = _core.RunOptions(threads=threads, steps=steps, seed=seed, audit=audit, resume=resume,
                               skip_bad_cells=skip_bad_cells, max_memory=max_memory, partition=partition)
    if out is not None:
        options.folder = pathlib.Path(out)
    return _core.run_scene(_plain(scene), options, progress, ranks)
