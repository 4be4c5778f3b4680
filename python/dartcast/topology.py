"""Maps and complexes, and their edits. Written by tools/make_stub.py."""
from ._core import (
    Across as Across, AcrossEdge as AcrossEdge, AfterSurfaceContact as AfterSurfaceContact, BladePath as BladePath,
    CarveOptions as CarveOptions, Carved as Carved, Carving as Carving, CellComplex as CellComplex,
    CellDraft as CellDraft, CellView as CellView, CombinatorialMap as CombinatorialMap, ComplexEdit as ComplexEdit,
    ComplexEditReport as ComplexEditReport, ConvexTool as ConvexTool, CreatedVertex as CreatedVertex,
    DraftCorner as DraftCorner, DraftFace as DraftFace, DraftForm as DraftForm, DraftLink as DraftLink,
    EditReport as EditReport, Forecast as Forecast, GoneTriangle as GoneTriangle, InvalidCell as InvalidCell,
    LeftCell as LeftCell, Location as Location, MendedRegion as MendedRegion, Mending as Mending,
    MergedVertex as MergedVertex, ParticleState as ParticleState, PlacedVertex as PlacedVertex,
    Placement as Placement, Plane as Plane, ReconnectOptions as ReconnectOptions, Reconnected as Reconnected,
    Reconnection as Reconnection, RepairOptions as RepairOptions, RepairReport as RepairReport,
    SURFACE_PLACE as SURFACE_PLACE, Section as Section, SectionOptions as SectionOptions, Shape as Shape,
    ShapeKey as ShapeKey, SplitEdge as SplitEdge, Subdivided as Subdivided, Subdivision as Subdivision,
    Surface as Surface, SurfaceContact as SurfaceContact, SurfaceCrossing as SurfaceCrossing,
    SurfaceEdit as SurfaceEdit, SurfaceEditReport as SurfaceEditReport, SurfaceEnd as SurfaceEnd,
    SurfaceLocation as SurfaceLocation, SurfaceLocator as SurfaceLocator, SurfaceOptions as SurfaceOptions,
    SurfacePlace as SurfacePlace, SurfaceReport as SurfaceReport, SurfaceStep as SurfaceStep,
    SurfaceTrace as SurfaceTrace, Transaction as Transaction, TyingOptions as TyingOptions, Violation as Violation,
    WallTriangles as WallTriangles, box_tool as box_tool, capsule_tool as capsule_tool, cell_orbit as cell_orbit,
    check_integrity as check_integrity, coarsen as coarsen, divide_into_simplices as divide_into_simplices,
    draft_of as draft_of, draw_together as draw_together, edge_orbit as edge_orbit, face_orbit as face_orbit,
    find_dart as find_dart, followed as followed, forecast as forecast, form_of as form_of, forms_of as forms_of,
    inner_walls as inner_walls, merge_cells as merge_cells, merge_edges as merge_edges, merge_faces as merge_faces,
    nearest_in_triangle as nearest_in_triangle, open_faces as open_faces, placement as placement,
    plane_through as plane_through, raised as raised, remove as remove, remove_walls as remove_walls,
    repair as repair, set_walls as set_walls, sew as sew, split_by_plane as split_by_plane, split_cell as split_cell,
    split_edge as split_edge, split_face as split_face, subdivide as subdivide, surface_places as surface_places,
    tangent as tangent, to_mesh as to_mesh, unsew as unsew, update_after_edit as update_after_edit,
    vertex_orbit as vertex_orbit, wall_triangles as wall_triangles)
from ._ids import Cell as Cell
from ._ids import CellFace as CellFace
from ._ids import CellHandle as CellHandle
from ._ids import Dart as Dart
from ._ids import Patch as Patch
from ._ids import SimplexId as SimplexId
from ._ids import Vertex as Vertex
