#!/usr/bin/env python3
"""Renames what dartcast 0.2 calls otherwise than 0.1, in C++ sources, in place.

    python3 tools/rename_0_2.py [--check] FILE_OR_FOLDER...

Comments and strings stay as they are; lines that include headers of dartcast are changed, and repeated ones removed. A name
that is a common word (State, Map, follow, ...) is renamed wherever it is a whole word of code: look at the changes before you
keep them. A header that is not installed any more is reported. --check changes nothing, and ends with status 1 where
something would change.
"""
import argparse
import pathlib
import re
import sys

SUFFIXES = {".cpp", ".hpp", ".h", ".cc", ".cxx", ".hh", ".hxx", ".inl", ".ipp"}

# Headers of 0.1, and the header of 0.2 that has their content.
HEADERS = {
    "dartcast/base/aligned.hpp": "dartcast/storage.hpp",
    "dartcast/base/error.hpp": "dartcast/error.hpp",
    "dartcast/base/ids.hpp": "dartcast/ids.hpp",
    "dartcast/base/parallel.hpp": "dartcast/threads.hpp",
    "dartcast/bodies/bodies.hpp": "dartcast/bodies.hpp",
    "dartcast/bodies/body_collisions.hpp": "dartcast/bodies.hpp",
    "dartcast/bodies/body_motion.hpp": "dartcast/bodies.hpp",
    "dartcast/bodies/camera_path.hpp": "dartcast/catheter.hpp",
    "dartcast/bodies/catheter.hpp": "dartcast/catheter.hpp",
    "dartcast/bodies/mat3.hpp": "dartcast/dynamics.hpp",
    "dartcast/bodies/rigid_solver.hpp": "dartcast/dynamics.hpp",
    "dartcast/bodies/sampling.hpp": "dartcast/bodies.hpp",
    "dartcast/bodies/shape_matching.hpp": "dartcast/bodies.hpp",
    "dartcast/environment/audit.hpp": "dartcast/audit.hpp",
    "dartcast/environment/environment.hpp": "dartcast/environment.hpp",
    "dartcast/environment/state_hash.hpp": "dartcast/audit.hpp",
    "dartcast/environment/trace.hpp": "dartcast/step.hpp",
    "dartcast/exact/predicates.hpp": "dartcast/predicates.hpp",
    "dartcast/exact/vec3.hpp": "dartcast/vec3.hpp",
    "dartcast/geometry/complex.hpp": "dartcast/cell_complex.hpp",
    "dartcast/geometry/complex_edit.hpp": "dartcast/complex_edit.hpp",
    "dartcast/geometry/complex_mesh.hpp": "dartcast/cell_complex.hpp",
    "dartcast/geometry/first_flattening.hpp": "dartcast/validity.hpp",
    "dartcast/geometry/flattening.hpp": "dartcast/validity.hpp",
    "dartcast/geometry/interior_weights.hpp": "dartcast/cell_complex.hpp",
    "dartcast/geometry/simplex.hpp": "dartcast/cell_complex.hpp",
    "dartcast/geometry/validity.hpp": "dartcast/validity.hpp",
    "dartcast/io/check_mesh.hpp": "dartcast/mesh_files.hpp",
    "dartcast/io/read_mesh.hpp": "dartcast/mesh_files.hpp",
    "dartcast/io/read_surface.hpp": "dartcast/mesh_files.hpp",
    "dartcast/io/run_scene.hpp": "dartcast/run.hpp",
    "dartcast/io/scene_file.hpp": "dartcast/scene_file.hpp",
    "dartcast/io/solids.hpp": "dartcast/simulation.hpp",
    "dartcast/io/summary.hpp": "dartcast/run.hpp",
    "dartcast/io/trajectory.hpp": "dartcast/trajectory.hpp",
    "dartcast/io/trajectory_csv.hpp": "dartcast/trajectory.hpp",
    "dartcast/io/trajectory_svg.hpp": "dartcast/trajectory.hpp",
    "dartcast/io/write_mesh.hpp": "dartcast/mesh_files.hpp",
    "dartcast/map/draft.hpp": "dartcast/map_edits.hpp",
    "dartcast/map/edit.hpp": "dartcast/map_edits.hpp",
    "dartcast/map/integrity.hpp": "dartcast/map_edits.hpp",
    "dartcast/map/map.hpp": "dartcast/combinatorial_map.hpp",
    "dartcast/map/orbits.hpp": "dartcast/map_edits.hpp",
    "dartcast/map/shape.hpp": "dartcast/cell_shape.hpp",
    "dartcast/map/shape_table.hpp": "dartcast/storage.hpp",
    "dartcast/map/side_table.hpp": "dartcast/storage.hpp",
    "dartcast/map/stars.hpp": "dartcast/cell_shape.hpp",
    "dartcast/map/transaction.hpp": "dartcast/map_edits.hpp",
    "dartcast/mesh/cell_types.hpp": "dartcast/mesh_data.hpp",
    "dartcast/mesh/decompose.hpp": "dartcast/decompose.hpp",
    "dartcast/mesh/generate_barrel.hpp": "dartcast/generators.hpp",
    "dartcast/mesh/generate_box.hpp": "dartcast/generators.hpp",
    "dartcast/mesh/generate_maze.hpp": "dartcast/generators.hpp",
    "dartcast/mesh/generate_octahedra.hpp": "dartcast/generators.hpp",
    "dartcast/mesh/generate_rectangle.hpp": "dartcast/generators.hpp",
    "dartcast/mesh/generate_vessel.hpp": "dartcast/generators.hpp",
    "dartcast/mesh/inspect.hpp": "dartcast/mesh_check.hpp",
    "dartcast/mesh/mesh_data.hpp": "dartcast/mesh_data.hpp",
    "dartcast/mesh/patches.hpp": "dartcast/mesh_selection.hpp",
    "dartcast/mesh/regions.hpp": "dartcast/mesh_selection.hpp",
    "dartcast/mesh/report.hpp": "dartcast/mesh_check.hpp",
    "dartcast/remesh/repair.hpp": "dartcast/remeshing.hpp",
    "dartcast/remesh/subdivide.hpp": "dartcast/remeshing.hpp",
    "dartcast/response/respond.hpp": "dartcast/response.hpp",
    "dartcast/simulation/crowding.hpp": "dartcast/events.hpp",
    "dartcast/simulation/deformation.hpp": "dartcast/deformation.hpp",
    "dartcast/simulation/event.hpp": "dartcast/events.hpp",
    "dartcast/simulation/field.hpp": "dartcast/vector_field.hpp",
    "dartcast/simulation/flow.hpp": "dartcast/simulation.hpp",
    "dartcast/simulation/polyline.hpp": "dartcast/simulation.hpp",
    "dartcast/simulation/scene.hpp": "dartcast/scene.hpp",
    "dartcast/simulation/seeding.hpp": "dartcast/simulation.hpp",
    "dartcast/simulation/surgery.hpp": "dartcast/events.hpp",
    "dartcast/spheres/advance_spheres.hpp": "dartcast/spheres.hpp",
    "dartcast/spheres/collide.hpp": "dartcast/dynamics.hpp",
    "dartcast/spheres/contact_solver.hpp": "dartcast/dynamics.hpp",
    "dartcast/spheres/sphere_touch.hpp": "dartcast/dynamics.hpp",
    "dartcast/surface/surface.hpp": "dartcast/surface.hpp",
    "dartcast/surface/surface_advance.hpp": "dartcast/surface.hpp",
    "dartcast/surface/surface_contact.hpp": "dartcast/surface.hpp",
    "dartcast/surface/surface_edit.hpp": "dartcast/surface.hpp",
    "dartcast/surface/surface_locator.hpp": "dartcast/surface.hpp",
    "dartcast/surface/surface_step.hpp": "dartcast/surface.hpp",
    "dartcast/surgery/carve.hpp": "dartcast/cutting.hpp",
    "dartcast/surgery/ligature.hpp": "dartcast/cutting.hpp",
    "dartcast/surgery/reconnect.hpp": "dartcast/cutting.hpp",
    "dartcast/surgery/section.hpp": "dartcast/cutting.hpp",
    "dartcast/surgery/tool.hpp": "dartcast/cutting.hpp",
    "dartcast/walk/contact.hpp": "dartcast/contact.hpp",
    "dartcast/walk/counters.hpp": "dartcast/step.hpp",
    "dartcast/walk/crossing.hpp": "dartcast/step.hpp",
    "dartcast/walk/locate.hpp": "dartcast/particle_state.hpp",
    "dartcast/walk/state.hpp": "dartcast/particle_state.hpp",
    "dartcast/walk/step.hpp": "dartcast/step.hpp",
}

# Types, functions, constants and members.
NAMES = {
    "act": "apply_impulse",
    "Added": "AddResult",
    "AddedBody": "AddBodyResult",
    "answered": "solved",
    "born": "created",
    "born_count": "created_count",
    "BornVertex": "CreatedVertex",
    "CellFlattening": "CellInversion",
    "Complex": "CellComplex",
    "Continuation": "AfterContact",
    "Crowding": "AdaptiveSubdivision",
    "CrowdingChange": "SubdivisionChange",
    "CrowdingOptions": "AdaptiveSubdivisionOptions",
    "CrowdingRefusal": "SubdivisionRefusal",
    "CrowdingReport": "AdaptiveSubdivisionReport",
    "CrowdingScene": "AdaptiveSubdivisionScene",
    "died": "deleted",
    "Fate": "ParticleStatus",
    "find_flattening": "find_inversion",
    "find_interior_points": "find_steiner_points",
    "first_flattening": "first_inversion",
    "Flattening": "SimplexInversion",
    "flattening_resolution": "inversion_resolution",
    "FlatteningKind": "InversionKind",
    "Flow": "Simulation",
    "FlowCheckpoint": "SimulationCheckpoint",
    "FlowEdit": "SimulationEdit",
    "FlowEnergy": "SimulationEnergy",
    "FlowOptions": "SimulationOptions",
    "FlowStep": "SimulationStep",
    "FlowTotals": "SimulationTotals",
    "follow": "update_after_edit",
    "follow_until": "move_towards",
    "FollowReport": "UpdateReport",
    "foreseen": "predicted_state",
    "Held": "HeldParticle",
    "Identified": "MergedVertex",
    "identified": "merged",
    "inspect": "check_and_repair",
    "inspect_surface": "check_and_repair_surface",
    "interior": "steiner_weights",
    "interior_point_count": "steiner_point_count",
    "interior_points": "steiner_points",
    "InteriorPoints": "SteinerPoints",
    "InteriorSolution": "SteinerSolution",
    "InteriorWeights": "SteinerWeights",
    "KeptImpulse": "CachedImpulse",
    "Map": "CombinatorialMap",
    "most_cells": "max_cells",
    "most_seed": "max_seed",
    "most_steps": "max_steps",
    "move_until_flattened": "move_until_inverted",
    "note_identified": "note_merged",
    "PlaneShift": "PlanarSymbolicPerturbation",
    "push_iterations": "position_iterations",
    "relieve": "adapt",
    "Respond": "ContactCallback",
    "Response": "WallResponse",
    "ResponseKind": "WallResponseKind",
    "Responses": "WallResponses",
    "set_kept": "set_cached_impulses",
    "Shift": "SymbolicPerturbation",
    "State": "ParticleState",
    "Stopped": "StoppedParticle",
    "Stranded": "OrphanPolicy",
    "stranded": "orphaned",
    "StrandedParticle": "OrphanedParticle",
    "SurfaceContinuation": "AfterSurfaceContact",
    "SurfaceRespond": "SurfaceContactCallback",
    "Surgery": "EventScheduler",
    "SurgeryLog": "EventLog",
    "survivor": "merged_into",
    "Twofold": "DoubleDouble",
}

# Names that only mean this after what stands before them.
PHRASES = [
    (re.compile(r"(\bOrphanPolicy\s*::\s*)stay\b"), r"\1hold"),
    (re.compile(r"(\bOrphanPolicy\s*::\s*)move\b"), r"\1relocate"),
    (re.compile(r"((?:\.|->)\s*)became\b"), r"\1outcome"),
    (re.compile(r"((?:\.|->)\s*)spin\b"), r"\1angular_velocity"),
    (re.compile(r"((?:\.|->)\s*)most\b"), r"\1max_count"),
]

PIECE = re.compile(
    r"(?P<kept>//[^\n]*|/\*.*?\*/|R\"\((?:.*?)\)\"|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*')|(?P<name>[A-Za-z_]\w*)|.",
    re.DOTALL)
INCLUDE = re.compile(r"^([ \t]*#[ \t]*include[ \t]*[<\"])(dartcast/[^>\"\n]+)([>\"][^\n]*\n)", re.MULTILINE)


def with_new_headers(text: str, path: pathlib.Path) -> str:
    seen = set()

    def line(match: re.Match) -> str:
        old = match.group(2)
        new = HEADERS.get(old, old)
        if old == new and old.count("/") > 1:
            print(f"{path}: {old} is not installed any more", file=sys.stderr)
        if new in seen:
            return ""
        seen.add(new)
        return match.group(1) + new + match.group(3)

    return INCLUDE.sub(line, text)


def with_new_names(text: str) -> str:
    def piece(match: re.Match) -> str:
        return match.group() if match.group("name") is None else NAMES.get(match.group(), match.group())

    text = PIECE.sub(piece, text)
    for pattern, replacement in PHRASES:
        text = pattern.sub(replacement, text)
    return text


def main() -> int:
    parser = argparse.ArgumentParser(description="Renames what dartcast 0.2 calls otherwise than 0.1.")
    parser.add_argument("--check", action="store_true", help="change nothing; status 1 where something would change")
    parser.add_argument("paths", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    changed = 0
    for root in arguments.paths:
        files = [root] if root.is_file() else sorted(p for p in root.rglob("*") if p.suffix in SUFFIXES)
        for path in files:
            old = path.read_text(encoding="utf-8")
            new = with_new_names(with_new_headers(old, path))
            if new == old:
                continue
            changed += 1
            print(path)
            if not arguments.check:
                path.write_text(new, encoding="utf-8")
    return 1 if arguments.check and changed else 0


if __name__ == "__main__":
    sys.exit(main())
