"""dartcast: exact continuous collision detection of particles and solids in deformable environments.

Arrays of points are float64 of shape (n, 3), C-contiguous; they are taken without a copy, and others are refused.
Results are fresh arrays. Arrays that are attributes are read-only copies.

More is in dartcast.topology (maps, complexes, their edits), dartcast.predicates (exact signs), dartcast.formats (files,
scenes as data, reports) and dartcast.records (what calls return, and options of options).
"""
from ._core import (
    __version__ as __version__, Absorb as Absorb, advance as advance, advance_spheres as advance_spheres,
    audit as audit, Bodies as Bodies, BodyOptions as BodyOptions, carve as carve, Catheter as Catheter, CellTally as CellTally,
    CatheterInput as CatheterInput, CatheterOptions as CatheterOptions, cells_near as cells_near,
    check_and_repair as check_and_repair, CollisionOptions as CollisionOptions, cut as cut,
    Deformation as Deformation, DeformationStep as DeformationStep, Disc as Disc, EditRefused as EditRefused,
    Environment as Environment, Error as Error, Escape as Escape, generate_bar as generate_bar,
    generate_barrel as generate_barrel, generate_box as generate_box, generate_maze as generate_maze,
    generate_octahedra as generate_octahedra, generate_rectangle as generate_rectangle,
    generate_vessel as generate_vessel, InUse as InUse, InvalidArgument as InvalidArgument,
    InvalidMesh as InvalidMesh, Kind as Kind, ligature as ligature, MeshData as MeshData, Particles as Particles,
    ParticleStatus as ParticleStatus, Place as Place, pull_around as pull_around, read_mesh as read_mesh, reconnect as reconnect,
    Reflect as Reflect, reflected as reflected, respond_with as respond_with, sample_solid as sample_solid,
    sample_surface as sample_surface, sample_volume as sample_volume, SharedEnvironment as SharedEnvironment,
    SharedParticles as SharedParticles, Simulation as Simulation, SimulationOptions as SimulationOptions,
    SimultaneousStepper as SimultaneousStepper, slid as slid, Slide as Slide, solid_of_cells as solid_of_cells,
    solid_of_polyline as solid_of_polyline, solid_of_surface as solid_of_surface, SolidSet as SolidSet,
    SolidStepOptions as SolidStepOptions, SphereStepper as SphereStepper, StatisticsOptions as StatisticsOptions,
    step as step, Stick as Stick, thicken as thicken, VectorField as VectorField, WallHits as WallHits,
    write_mesh as write_mesh)
from . import formats as formats, predicates as predicates, records as records, topology as topology
from ._meshio import from_meshio as from_meshio, to_meshio as to_meshio
from ._ids import NONE as NONE
from ._ranks import Ranks as Ranks, mpi_ranks as mpi_ranks
from ._results import flat as flat, read_run as read_run
from ._run import load_scene as load_scene, run as run, scene_text as scene_text
from . import _display as _display
