#!/usr/bin/env python3
"""Renames what dartcast 0.2 calls otherwise than 0.1: in .cpp, .hpp and similar files, in place.

    python3 tools/rename_0_2.py [--check] FILE_OR_FOLDER...

Comments and strings stay as they are. A name of one common word (State, Map, kept, ...) is renamed wherever it is a whole
word of code: look at the changes before you keep them. --check changes nothing, and ends with 1 where something would change.
"""
import argparse
import pathlib
import re
import sys

SUFFIXES = {".cpp", ".hpp", ".h", ".cc", ".cxx", ".hh", ".hxx", ".inl", ".ipp"}

# Headers of 0.1 and where their content is in 0.2. None: it is no longer installed.
HEADERS = {
}

# Types, functions and constants.
NAMES = {
    "Flow": "Simulation",
    "FlowOptions": "SimulationOptions",
    "FlowStep": "SimulationStep",
    "FlowTotals": "SimulationTotals",
    "FlowCheckpoint": "SimulationCheckpoint",
    "FlowEnergy": "SimulationEnergy",
    "FlowEdit": "SimulationEdit",
    "Fate": "ParticleStatus",
    "State": "ParticleState",
    "Map": "CombinatorialMap",
    "Complex": "CellComplex",
    "Response": "WallResponse",
    "Responses": "WallResponses",
    "ResponseKind": "WallResponseKind",
    "Respond": "ContactCallback",
    "Continuation": "AfterContact",
    "SurfaceRespond": "SurfaceContactCallback",
    "SurfaceContinuation": "AfterSurfaceContact",
    "Added": "AddResult",
    "AddedBody": "AddBodyResult",
    "Stopped": "StoppedParticle",
    "Held": "HeldParticle",
    "Stranded": "OrphanPolicy",
    "StrandedParticle": "OrphanedParticle",
    "FollowReport": "UpdateReport",
    "follow": "update_after_edit",
    "Surgery": "EventScheduler",
    "SurgeryLog": "EventLog",
    "Crowding": "AdaptiveSubdivision",
    "CrowdingOptions": "AdaptiveSubdivisionOptions",
    "CrowdingRefusal": "SubdivisionRefusal",
    "CrowdingChange": "SubdivisionChange",
    "CrowdingReport": "AdaptiveSubdivisionReport",
    "CrowdingScene": "AdaptiveSubdivisionScene",
    "relieve": "adapt",
    "first_flattening": "first_inversion",
    "find_flattening": "find_inversion",
    "CellFlattening": "CellInversion",
    "Flattening": "SimplexInversion",
    "FlatteningKind": "InversionKind",
    "flattening_resolution": "inversion_resolution",
    "move_until_flattened": "move_until_inverted",
    "follow_until": "move_towards",
    "inspect": "check_and_repair",
    "inspect_surface": "check_and_repair_surface",
    "judge": "plan_replacement",
    "InteriorPoints": "SteinerPoints",
    "InteriorWeights": "SteinerWeights",
    "InteriorSolution": "SteinerSolution",
    "find_interior_points": "find_steiner_points",
    "interior": "steiner_weights",
    "interior_point_count": "steiner_point_count",
    "BornVertex": "CreatedVertex",
    "Identified": "MergedVertex",
    "note_identified": "note_merged",
    "born_count": "created_count",
    "born": "created",
    "died": "deleted",
    "identified": "merged",
    "survivor": "merged_into",
    "KeptImpulse": "CachedImpulse",
    "kept": "cached_impulses",
    "set_kept": "set_cached_impulses",
    "foreseen": "predicted_state",
    "act": "apply_impulse",
    "answered": "solved",
    "push_iterations": "position_iterations",
    "Shift": "SymbolicPerturbation",
    "PlaneShift": "PlanarSymbolicPerturbation",
    "Twofold": "DoubleDouble",
    "Landing": "WallImpact",
    "Begun": "PartialStep",
    "Memo": "SimplexCacheEntry",
    "Memos": "SimplexCache",
    "Settled": "SimplexPlacement",
    "settle": "place_in_simplex",
    "most_seed": "max_seed",
    "most_steps": "max_steps",
    "most_cells": "max_cells",
}

# Members of one word that only mean this after the text before them.
PHRASES = [
    (r"(\bOrphanPolicy::)stay\b", r"\1hold"),
    (r"(\bOrphanPolicy::)move\b", r"\1relocate"),
    (r"(\.)stranded\b", r"\1orphaned"),
    (r"(\.)became\b", r"\1outcome"),
    (r"(\.)most\b", r"\1max_count"),
    (r"(\.)least\b", r"\1min_count"),
    (r"(\.)spin\b", r"\1angular_velocity"),
    (r"(\.)shift\b", r"\1position_delta"),
    (r"(\.)push\b", r"\1position_correction"),
]
