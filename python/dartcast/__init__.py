"""dartcast: exact continuous collision detection of particles and solids in deformable environments.

Arrays of points are float64 of shape (n, 3), C-contiguous; they are taken without a copy, and others are refused.
Results are fresh arrays. Arrays that are attributes are read-only copies.

More is in dartcast.topology (maps, complexes, their edits), dartcast.predicates (exact signs), dartcast.formats (files,
scenes as data, reports) and dartcast.records (what calls return, and options of options).
"""
from ._core import (
    __version__ as __version__, Absorb as Absorb, advance as advance, advance_spheres as advance_spheres,
    AfterContact as AfterContact, audit as audit, BarrelOptions as BarrelOptions, BladePath as BladePath,
    Bodies as Bodies, BodiesOptions as BodiesOptions, BodyOptions as BodyOptions, BoxOptions as BoxOptions,
    camera_path as camera_path, Carve as Carve, carve as carve, Catheter as Catheter, CatheterInput as CatheterInput,
    CatheterOptions as CatheterOptions, cells_near as cells_near, CellType as CellType,
    check_and_repair as check_and_repair, check_mesh as check_mesh, CloseCells as CloseCells,
    CollisionOptions as CollisionOptions, Contact as Contact, ConvexTool as ConvexTool, Cut as Cut, cut as cut,
    Deformation as Deformation, DeformationKind as DeformationKind, DeformationStep as DeformationStep, Disc as Disc,
    EditRefused as EditRefused, Environment as Environment, Error as Error, Escape as Escape, Event as Event,
    FieldFrame as FieldFrame, FieldPlace as FieldPlace, FieldSamples as FieldSamples, generate_bar as generate_bar,
    generate_barrel as generate_barrel, generate_box as generate_box, generate_maze as generate_maze,
    generate_octahedra as generate_octahedra, generate_rectangle as generate_rectangle,
    generate_vessel as generate_vessel, Integrator as Integrator, InternalError as InternalError,
    Interpolation as Interpolation, InUse as InUse, InvalidArgument as InvalidArgument, InvalidMesh as InvalidMesh,
    Kind as Kind, Ligature as Ligature, ligature as ligature, Location as Location, MatchOptions as MatchOptions,
    max_threads as max_threads, MazeOptions as MazeOptions, MeshData as MeshData, MeshFile as MeshFile,
    OctahedraOptions as OctahedraOptions, OpenCells as OpenCells, OrphanPolicy as OrphanPolicy,
    Particles as Particles, ParticleStatus as ParticleStatus, Place as Place, Plane as Plane,
    RankFailed as RankFailed, read_mesh as read_mesh, read_surface as read_surface, ReadOptions as ReadOptions,
    Reconnect as Reconnect, reconnect as reconnect, RectangleOptions as RectangleOptions, Reflect as Reflect,
    reflected as reflected, respond_with as respond_with, run_scene as run_scene, RunOptions as RunOptions,
    sample_solid as sample_solid, sample_surface as sample_surface, sample_volume as sample_volume,
    SamplingOptions as SamplingOptions, Scene as Scene, SectionPlane as SectionPlane,
    SharedEnvironment as SharedEnvironment, SharedParticles as SharedParticles, Simulation as Simulation,
    SimulationOptions as SimulationOptions, SimulationStep as SimulationStep,
    SimultaneousStepper as SimultaneousStepper, slid as slid, Slide as Slide, solid_of_cells as solid_of_cells,
    solid_of_polyline as solid_of_polyline, solid_of_surface as solid_of_surface, SolidMesh as SolidMesh,
    SolidSet as SolidSet, SolidStepOptions as SolidStepOptions, SphereStepper as SphereStepper,
    StatisticsOptions as StatisticsOptions, step as step, StepOptions as StepOptions, StepReport as StepReport,
    Stick as Stick, Summary as Summary, Surface as Surface, SurfaceEdit as SurfaceEdit,
    SurfaceLocator as SurfaceLocator, SurfaceOptions as SurfaceOptions, SurfacePlace as SurfacePlace,
    thicken as thicken, VectorField as VectorField, version as version, VesselOptions as VesselOptions,
    WallHit as WallHit, WallHits as WallHits, WallMotion as WallMotion, WallResponse as WallResponse,
    WallResponses as WallResponses, write_mesh as write_mesh)
from . import formats as formats, predicates as predicates, records as records, topology as topology
from ._meshio import from_meshio as from_meshio, to_meshio as to_meshio
from ._ids import NONE as NONE, Cell as Cell, CellFace as CellFace, CellHandle as CellHandle, Dart as Dart
from ._ids import Patch as Patch, SimplexId as SimplexId, Vertex as Vertex
from ._ranks import Ranks as Ranks, mpi_ranks as mpi_ranks
from ._run import load_scene as load_scene, run as run, scene_text as scene_text
