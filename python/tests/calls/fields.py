"""Deformations and fields, with their readers."""
from __future__ import annotations

import copy

import numpy as np

import dartcast as dc

from . import Calls, refused
from .environments import raising
from .scenes import environment, first

REST = np.random.default_rng(1).uniform(-1, 1, (20, 3))


def frames(reader: object = None, **named: object) -> dc.DeformationStep:
    return dc.DeformationStep(kind="frames", times=[0.0, 1.0, 2.0], reader=reader, **named)


def of_deformations() -> Calls:
    steps = [dc.DeformationStep(kind="rotate", period=4.0), dc.DeformationStep(kind="twist", amplitude=0.2)]
    deformation = dc.Deformation(steps, REST)
    pull, out = np.zeros_like(REST), np.empty_like(REST)
    placed = dc.topology.PlacedVertex(20, np.array([0, 1]), [0.5, 0.5], [0, 0, 0])
    report = dc.topology.ComplexEditReport(placed=[placed])
    held = dc.Deformation([frames(frames=[REST, 3 * REST, REST])], REST)
    plane = dc.Deformation([], REST * [1.0, 1.0, 0.0])
    wrong = dc.Deformation([dc.DeformationStep(kind="twist", axis=[1.0, 0, 0])], REST * [1.0, 1.0, 0.0])

    def read() -> None:
        own = dc.Deformation([frames(lambda k: [REST, 3 * REST, REST][k])], REST)
        for time in (0.5, 1.5):
            own.load_frames(time)
            own.positions(time, threads=1)

    return {
        "Deformation": lambda: dc.Deformation(steps, REST),
        "Deformation: refused": refused(lambda: dc.Deformation([dc.DeformationStep(kind="rotate", period=0.0)], REST)),
        "Deformation.__len__": lambda: len(deformation), "Deformation.__copy__": lambda: copy.copy(deformation),
        "Deformation.__deepcopy__": lambda: copy.deepcopy(deformation),
        "Deformation.check_plane": plane.check_plane, "Deformation.check_plane: refused": refused(wrong.check_plane),
        "Deformation.update_after_edit": lambda: dc.Deformation(steps, REST).update_after_edit(report, 21),
        "Deformation.update_after_edit: refused": refused(lambda: deformation.update_after_edit(report, 5)),
        "Deformation.add_pull": lambda: dc.Deformation(steps, REST).add_pull(pull, 1.0, 2.0),
        "Deformation.add_pull: refused": refused(lambda: deformation.add_pull(pull, 2.0, 1.0)),
        "Deformation.positions": lambda: deformation.positions(0.3, threads=1),
        "Deformation.positions: out": lambda: deformation.positions(0.3, out, threads=1),
        "Deformation.positions: frames": lambda: held.positions(0.5, threads=1),
        "Deformation.positions: refused": refused(lambda: deformation.positions(0.3, out[1:].copy(), threads=1)),
        "Deformation.load_frames": read, "Deformation.load_frames: raised": refused(
            lambda: dc.Deformation([frames(raising)], REST).load_frames(0.5)),
        "deformation_kind": lambda: dc.records.deformation_kind("bend"), "name_of": lambda: dc.formats.name_of(dc.records.EventKind.CUT),
        "name_of: deformation": lambda: dc.formats.name_of(dc.records.DeformationKind.BEND),
    }


def of_fields() -> Calls:
    env = environment(type="tetrahedron")
    n = len(env.positions)
    values = [np.ones((n, 3)), np.zeros((n, 3))]
    field = dc.VectorField(env.complex, values[0])
    simplex = env.locate([0.21, 0.34, 0.83]).simplex
    corners, w = env.complex.corners(simplex), [0.25] * 4
    samples = dc.records.FieldSamples(times=[0.0, 1.0], read=lambda k: values[k], period=4.0)
    turned = environment()

    def read() -> None:
        own = dc.VectorField(env.complex, samples)
        own.hold(0.0, 0.5)
        own.set_times([0.25, 0.5], env.complex, threads=1)
        own.at(env.complex, simplex, w, corners, 1)

    def follow() -> None:
        own = environment()
        own_field = dc.VectorField(own.complex, own.positions.copy())
        report = own.edit(lambda edit: dc.topology.split_edge(edit.topology, (first(edit.map), 0)))
        own_field.update_after_edit(report, own.complex)

    mesh_field = dc.VectorField(turned.complex, turned.positions.copy(), dc.records.FieldFrame.MESH)
    bad = dc.topology.ComplexEditReport(placed=[dc.topology.PlacedVertex(3, np.array([999]), [1.0])])
    return {
        "VectorField": lambda: dc.VectorField(env.complex, values[0]),
        "VectorField: mesh": lambda: dc.VectorField(env.complex, values[0], "mesh"),
        "VectorField: cells": lambda: dc.VectorField(env.complex, dc.records.field_samples(
            [0.0], [np.ones((env.map.cell_count(), 3))], "cells")),
        "VectorField: refused": refused(lambda: dc.VectorField(env.complex, values[0][1:].copy())),
        "VectorField.hold": read, "VectorField.set_times": read,
        "VectorField.set_times: refused": refused(lambda: field.set_times([], env.complex)),
        "VectorField.set_times: raised": refused(lambda: dc.VectorField(env.complex, dc.records.FieldSamples(
            times=[0.0, 1.0], read=raising)).set_times([0.5], env.complex, threads=1)),
        "VectorField.at": lambda: field.at(env.complex, simplex, w, corners),
        "VectorField.at: mesh": lambda: mesh_field.at(turned.complex, (first(turned.map), 0), w, corners),
        "VectorField.at: refused": refused(lambda: field.at(env.complex, simplex, w, corners, 2)),
        "VectorField.update_after_edit": follow,
        "VectorField.update_after_edit: refused": refused(lambda: field.update_after_edit(bad, env.complex)),
        "field_samples": lambda: dc.records.field_samples([0.0, 1.0], values),
        "field_samples: refused": refused(lambda: dc.records.field_samples([0.0], values)),
    }


def calls() -> Calls:
    return of_deformations() | of_fields()
