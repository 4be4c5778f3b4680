"""How objects look: a line for terminals, a table for notebooks. And what makes sets of particles sequences."""
from __future__ import annotations

import base64
import html
import operator
from collections.abc import Callable, Iterator
from typing import Any, Optional

import numpy

from . import _core, _plots
from ._results import Run

Rows = Iterator[dict[str, Any]]


def _text(value: Any) -> str:
    return f"{value:,}" if isinstance(value, (int, numpy.integer)) else \
        f"{value:.4g}" if isinstance(value, float) else str(value)


def _show(cls: type, rows: Callable[[Any], Rows], picture: Callable[[Any], Optional[bytes]] = lambda _: None) -> None:
    """Gives a class its representations. `rows`: first those for the line, then those that the table has, too."""
    def line(self: Any) -> str:
        try:
            shown = ", ".join(f"{_text(value)} {name}" for name, value in next(rows(self)).items())
        except _core.InUse:
            shown = "in use by a call in another thread"
        return f"<dartcast.{cls.__name__}: {shown}>"

    def table(self: Any) -> str:
        try:
            found = {"time [s]" if name == "s" else name: value for part in rows(self) for name, value in part.items()}
            png = picture(self)
        except _core.InUse:
            return f"<pre>{html.escape(line(self))}</pre>"
        body = "".join(f"<tr><th style='text-align:left'>{html.escape(name)}</th><td style='text-align:right'>"
                       f"{html.escape(_text(value))}</td></tr>" for name, value in found.items())
        shown = "" if png is None else f"<img alt='particles among their walls, by speed' style='max-width:100%' " \
                                       f"src='data:image/png;base64,{base64.b64encode(png).decode()}'>"
        return f"<table><caption>dartcast.{cls.__name__}</caption>{body}</table>{shown}"

    setattr(cls, "__repr__", line)
    setattr(cls, "_repr_html_", table)


def _environment(e: Any) -> Rows:
    map_ = e.map
    yield {"cells": map_.cell_count(), "vertices": map_.vertex_count}
    yield {"free cells": int(map_.is_free(map_.cells()).sum()), "dimension": map_.dimension, "wall faces":
           map_.wall_face_count(), "patches": ", ".join(filter(None, map_.patch_names)), "edits": e.edit_count,
           "threads": e.threads}
    for axis, low, high in zip("xyz", e.positions.min(axis=0), e.positions.max(axis=0)):
        yield {f"{axis} [m]": f"{low:.4g} to {high:.4g}"}


def _particles(p: Any) -> Rows:
    yield {"particles": len(p)}
    yield {"held": int(p.held.sum()), "at walls": int((p.touching_counts > 0).sum()), "cells": len(set(p.cells.tolist()))}


def _mesh_part(p: Any) -> Rows:
    yield {"cells": len(p.cells), "own": int((p.owners == p.part).sum())}
    yield {"points": len(p.points), "part": f"{p.part} of {p.parts}"}


def _step_report(r: Any) -> Rows:
    yield {"contacts": len(r.contacts), "stopped": len(r.stopped), "held": len(r.held)}
    yield {f"contacts at a {kind.name.lower()}": int((r.contacts["kind"] == kind).sum()) for kind in _core.Kind
           if kind != _core.Kind.VOLUME}
    yield {"orientation tests": r.counters.orientation.tests}


def _simulation(s: Any) -> Rows:
    yield {"steps": s.steps, "s": s.time, "particles": len(s.statuses)}
    totals = s.totals
    yield {"injected": totals.injected, "escaped": totals.escaped, "absorbed": totals.absorbed,
           "cells": s.environment.map.cell_count(), "dt [s]": s.options.dt}


def _summary(s: Any) -> Rows:
    yield {"steps": s.steps, "particles": s.alive, "escaped": s.totals.escaped, "absorbed": s.totals.absorbed, "lost": s.lost}
    yield {"scene": s.scene, "cells": s.cells, "contacts": sum(s.totals.counters.contacts), "state hash": s.state_hash}
    yield {} if s.audit is None else {"audit: wrong particles": s.audit.failed}
    yield {} if s.report is None else {"report": s.report.file}


def _run(r: Any) -> Rows:
    yield {"frames": len(r), "steps": len(r.stats)}
    yield {"folder": r.folder, **({} if not len(r) else {"particles at the end": len(r[-1]), "s": float(r.times[-1])})}


def _of_simulation(s: Any) -> Optional[bytes]:
    return _plots.picture(_core.to_mesh(s.environment.complex), s.positions, s.velocities)


def _of_run(r: Run) -> Optional[bytes]:
    return _plots.picture(r[-1].mesh, r[-1].positions, r[-1].arrays["velocity"]) if len(r) else None


def _of_summary(s: Any) -> Optional[bytes]:
    return None if s.report is None or not s.report.file.exists() else _of_run(Run(s.report.file.parent))


_item = _core.Particles.__getitem__


def _getitem(self: Any, i: Any) -> Any:
    """__getitem__(self, i: int) -> ParticleState
    __getitem__(self, i: slice | Integers | Marks) -> Particles

    The state of a particle, a copy; -1 is the last one. Of a slice, of numbers or of a mask: a set with these particles.
    """
    if isinstance(i, slice):
        return self.selected(numpy.arange(len(self))[i])
    if numpy.ndim(i) == 1:
        return self.selected(numpy.arange(len(self))[numpy.asarray(i) if len(i) else slice(0)])
    number = operator.index(i)
    if not -len(self) <= number < len(self):
        raise IndexError(f"there is no particle {number}: there are {len(self)}")
    return _item(self, number % len(self))


def _iter(self: Any) -> Any:
    """__iter__(self) -> Iterator[ParticleState]

    The state of each particle."""
    return (_item(self, i) for i in range(len(self)))


def _reduce(self: Any) -> Any:
    return type(self), (self.states, self.held_weights())


_show(_core.Environment, _environment)
_show(_core.MeshPart, _mesh_part)
_show(_core.Particles, _particles)
_show(_core.StepReport, _step_report)
_show(_core.Simulation, _simulation, _of_simulation)
_show(_core.Summary, _summary, _of_summary)
_show(Run, _run, _of_run)
for _name, _function in (("__getitem__", _getitem), ("__iter__", _iter), ("__reduce__", _reduce)):
    _function.__name__ = _name
    setattr(_core.Particles, _name, _function)
