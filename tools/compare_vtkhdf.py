#!/usr/bin/env pvpython
"""Compares a run's .vtkhdf file, as ParaView (5.12 or later) or VTK (9.3) reads it, with the frames of the run.

compare_vtkhdf.py RUN FILE.vtkhdf, run by pvpython, pvbatch, or a python3 that has vtk. No test of ./dev runs it:
Debian 12 has no ParaView that is new enough.
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader


def read_frame(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def point_array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def compare_particles(data, frame):
    of_particles = point_array(data, "is_particle") == 1
    points = vtk_to_numpy(data.GetPoints().GetData())
    assert of_particles.sum() == frame.GetNumberOfPoints() == data.GetNumberOfVerts()
    if frame.GetNumberOfPoints() == 0:
        return
    assert np.array_equal(points[of_particles], vtk_to_numpy(frame.GetPoints().GetData()))
    for name in ("velocity", "radius", "id"):
        assert np.array_equal(point_array(data, name)[of_particles], point_array(frame, name)), name


def main():
    run, file = pathlib.Path(sys.argv[1]), sys.argv[2]
    frames = sorted(run.glob("particles_*.vtp"))
    reader = vtkHDFReader()
    reader.SetFileName(file)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())
    assert len(times) == len(frames), (len(times), len(frames))
    for time, frame in zip(times, frames):
        reader.UpdateTimeStep(time)
        data = reader.GetOutputDataObject(0)
        compare_particles(data, read_frame(frame))
        walls = data.GetNumberOfPolys() + data.GetNumberOfLines()
        print(f"{time:.6g} s: {data.GetNumberOfVerts()} particles, {walls} walls, bounds {data.GetBounds()}")
    print(f"VTK {vtkVersion.GetVTKVersion()} reads {len(times)} frames as they were written")


if __name__ == "__main__":
    main()
