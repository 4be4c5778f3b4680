#!/usr/bin/env python3
"""Writes what the Python bindings take from the public headers. Usage: make_bindings.py HEADERS OUT.

OUT/docs.inl has a docstring for each name, OUT/enums.inl a conversion for each enumeration. OUT/rows.inl has the
rows of structured arrays (ROWS), OUT/members.inl the members of classes (CLASSES). OUT/records_N.cpp bind the enumerations, constants and plain records, and functions
that need no more than their types (FUNCTIONS). A record is a struct whose members all can be read and set. Structs that need
thought are in BY_HAND, and python/src binds them.
"""
from __future__ import annotations

import collections
import keyword
import pathlib
import re
import sys

import read_headers

# C++ words of the headers, and what Python says.
WORDS = [(r"\bThrows\b", "Raises"), (r"\bthrows\b", "raises"), (r"(\w)::(?=\w)", r"\1."), (r"\bnull\b", "None"),
         (r"\bstd\.", ""), (r"\bdartcast/(\w+)\.hpp", r"\1.hpp")]
# Structs that are no records in Python: rows of arrays, numbers, tuples, and classes that python/src binds.
BY_HAND = set("""
    AddResult BodiesCheckpoint CatheterCheckpoint Cell CellFace CellHandle ContactList Dart DataArray Drops FaceHits
    HeldParticle Id ImplicitSimplex LawParticles LawResult LawSamples LeftParticle MeshData MeshFile MeshPart OrphanedParticle Patch PathPoint
    PeriodicCrossing PlaneCrossing PlanePassage RayCells RayHit ReplayResult SimplexId SolidAudit SolidCheckpoint SolidContact
    SolidMeeting SolidMesh SolidPlacement SolidStep SphereOverlap SphereReport Stars Statistics SteinerPoints StepReplay
    StepReport StoppedParticle Subdivided Subdivision SurfaceReport SurfaceTrace TalliedParticles Threads TouchedFaces Trace
    Transaction UpdateReport Vec3 VelocityGradient WallTriangles
    """.split())
# Members that are arrays or objects of Python, which python/src binds.
MEMBERS_BY_HAND = {"BodiesStep::edges", "ReadOptions::on_stage", "RunOptions::on_stage", "RunOptions::ranks",
                   "SimulationOptions::ranks", "SimulationStep::contact_sources", "SimulationStep::left",
                   "SimulationStep::overlaps"}
# Columns of structured arrays, a row for each struct: members, or NAME:MEMBER of a member, or NAME:CODE about the struct x.
PLACE = "place:{0}place kind:{0}kind simplex:{0}simplex.simplex dart:{0}dart.number cell:{0}simplex.cell dart_cell:{0}dart.cell"
FACE = "cell:face.cell face:face.face"
ROWS = {
    "ContactAtWall": "particle kind last patch time_of_impact point normal wall_displacement displacement unused first_wall "
                     "wall_count earlier together cell:dart.cell dart:dart.number",
    "WallHit": f"{FACE} triangle patch normal",
    "ParticleState": "position cell simplex touching_count held touching_cell:cells_of(x.touching) "
                     "touching_face:faces_of(x.touching)",
    "Location": PLACE.format(""),
    "RayHit": f"origin hit kind {FACE} triangle patch distance point normal invalid_cell",
    "HeldParticle": "particle cell",
    "StoppedParticle": "particle unused",
    "PeriodicCrossing": "particle pair back contacts time from_cell:from.cell from_face:from.face to_cell:to.cell "
                        "to_face:to.face point turn",
    "OrphanedParticle": "particle place outcome position distance",
    "LeftParticle": "id status position contact",
    "SphereOverlap": f"particle {FACE} depth left point normal",
    "SolidContact": f"solid kind count wall_kind vertices weights {FACE} triangle dart:dart.number patch time_of_impact gap "
                    "point wall_point normal displacement wall_displacement",
    "SolidMeeting": "solid other kind count vertices other_vertices weights other_weights time_of_impact gap point "
                    "other_point normal",
    "FaceHits": f"{FACE} patch hits mass energy angles",
    "PlaneCrossing": "plane particle forward share point",
    "PlanePassage": "plane:crossing.plane particle:crossing.particle forward:crossing.forward share:crossing.share "
                    "point:crossing.point id time age number",
    "PathPoint": "id time position velocity contact",
    "SimplexId": "cell simplex",
    "SurfacePlace": "cell:triangle.cell simplex:triangle.simplex weights",
    "SurfaceStep": "end contacts crossings length direction remaining",
    "SurfaceContact": "particle kind dart_cell:dart.cell dart:dart.number patch time_of_impact place:row_of(x.place) point "
                      "normal sides displacement unused",
}
# Structs that Python cannot make or change, and their members that are structured arrays.
READ_ONLY = {"CatheterCheckpoint": "", "MeshPart": "", "SolidAudit": "", "SolidCheckpoint": "", "SolidStep": "contacts meetings",
             "SphereReport": "overlaps", "Statistics": "passages path_points", "UpdateReport": "orphaned"}
# Functions that Python calls as they are, and methods and properties of records.
FUNCTIONS = """
    are_extents are_plane_extents bar_options bound_holds box_part box_tool capsule_tool carve cell_orbit
    cells_of_region check_mesh check_surface check_threads decompose divide_into_simplices draft_of edge_orbit
    face_orbit filter_applies generate_bar has_parts histogram_text inner_walls is_mass is_radius is_surface_file
    kind_of load_scene_files max_threads merge_cells merge_edges merge_faces mesh_endings mesh_part mesh_surfaces
    open_faces overlapping_clusters parse_scene partition plane_bound_holds plane_filter_applies plane_through pull_around
    read_mesh_part read_scene read_surface read_valid_mesh remove_walls repair report_file sample_solid
    sample_surface sample_volume select_free_regions select_free_values select_patches select_walls set_walls sew
    solid_of_cells solid_of_polyline split_by_plane split_edge split_face summary_json summary_text surface_endings
    trajectory_points unsew verdict_name version vertex_orbit writable_mesh_endings write_lagrangian
    write_mesh_parts write_report write_sources write_wall_hits
    """.split()
METHODS = """
    Audit::operator+= CollisionCounts::operator+= ComplexEditReport::now Counters::operator+= Finding::add
    ParticleState::put ResidenceTimes::mean RigidMotion::velocity_at RigidMover::velocity_at RunPlan::efficiency
    RunPlan::seconds StatisticsOptions::any StatisticsOptions::pathlines
    """.split()
# Docstrings of those that say too little to have a comment.
SAID = {
    "RigidMotion::velocity_at": "The velocity of the rigid motion at a point.",
    "RunPlan::seconds": "The time of a step, s.",
    "ResidenceTimes::mean": "The mean, s; 0 where there is none.",
    "StatisticsOptions::any": "Whether anything is kept.",
    "StatisticsOptions::pathlines": "Whether there are pathlines.",
    "Bodies::id": "The body's id.",
    "Bodies::particle_count": "The number of its particles.",
    "Bodies::energy": "Its energy, J.",
    "Bodies::rigid_motion_of": "The rigid motion with its momentum.",
    "Bodies::size": "The number of bodies.",
    "Bodies::options": "A copy.",
    "Bodies::steps": "Steps done.",
    "Bodies::particles": "A copy of all particles, body by body.",
    "Bodies::positions": "Of all particles, float64 (n, 3).",
    "Bodies::masses": "float64 (n,).",
    "Bodies::radii": "float64 (n,).",
    "Bodies::statuses": "Of all particles, uint8 (n,): values of ParticleStatus.",
    "Catheter::total_length": "Of the whole catheter, m.",
    "Catheter::turned": "Turns so far, rad.",
    "Catheter::entry": "Where it enters now.",
    "Catheter::direction": "In which it enters now.",
    "Catheter::options": "A copy.",
    "Catheter::state_hash": "Of all its points.",
    "Catheter::checkpoint": "The state, for restore().",
    "CellComplex::previous_positions": "Positions before the last move(); equal to positions before the first.",
    "CellComplex::previous_corners": "The positions of a simplex's corners before the last move: float64 (4, 3).",
    "CellComplex::simplex_count": "The number of implicit simplices.",
    "CellComplex::steiner_point_count": "The number of Steiner points.",
    "CellComplex::invalid_cells": "Cells that no Steiner point made positive, as a list of InvalidCell.",
    "CombinatorialMap::phi1": "The next dart of the face.",
    "CombinatorialMap::phi_1": "The dart before it in the face.",
    "CombinatorialMap::origin": "The vertex that the dart starts from.",
    "CombinatorialMap::face": "The face of the dart.",
    "CombinatorialMap::flat": "Marks that edits left at the dart.",
    "CombinatorialMap::handle": "The handle of a cell. Raises InvalidArgument where there is no such cell.",
    "CombinatorialMap::cells": "All cells, pool by pool: uint32 (n,).",
    "CombinatorialMap::bytes": "Size in memory.",
    "Environment::positions": "Positions of the mesh's points: float64 (n, 3), a read-only copy.",
    "Environment::edit_count": "The number of edits so far.",
    "Particles::size": "The number of particles.",
    "SharedParticles::size": "The number of particles here.",
    "SharedParticles::width": "The numbers of each particle.",
    "SharedParticles::ids": "uint64 (n,), a read-only copy: in the order of adding, from 0.",
    "Simulation::checkpoint": "All that the simulation goes on from.",
    "Simulation::particles":
        "A copy of the particles: a set of its own. For their positions alone: Simulation.positions.",
    "Simulation::ids": "uint64 (n,).",
    "Simulation::velocities": "float64 (n, 3).",
    "Simulation::statuses": "uint8 (n,): values of ParticleStatus.",
    "Simulation::contact_counts": "uint32 (n,).",
    "Simulation::radii": "float64 (n,).",
    "Simulation::diameters": "float64 (n,).",
    "Simulation::densities": "float64 (n,).",
    "Simulation::charges_per_mass": "float64 (n,).",
    "Simulation::bodies_step": "The last one.",
    "Simulation::catheter_count": "The number of catheters.",
    "Simulation::solids_step": "A copy of the last step of the solids.",
    "Simulation::solid_summaries": "The solids, by number.",
    "Simulation::catheter_summaries": "By the order of adding.",
    "Simulation::statistics": "A copy of the statistics so far; empty where none are kept.",
    "Simulation::statistics_options": "A copy.",
    "Simulation::totals": "Sums over all steps so far: a copy.",
    "Simulation::event_log": "A copy.",
    "Simulation::options": "A copy.",
    "Simulation::time": "s: steps times dt.",
    "Simulation::steps": "Steps done.",
    "Simulation::deforms": "Whether it has a deformation.",
    "SolidSet::size": "The number of solids.",
    "SolidSet::checkpoint": "The state, for restore().",
    "Transaction::removed": "Removed cells, of those that existed at the last commit.",
    "Transaction::merged": "Vertices that were merged into others, as a list of MergedVertex.",
    "Transaction::created_count": "The number of vertices made since the last commit.",
    "VectorField::steady": "Whether it has one sample.",
}
PROPERTIES = """
    Across::face Across::outer BodyEnergy::total FieldScene::given MeshReport::valid MeshReport::verdict
    RigidMotion::kinetic_energy SurfacePlace::kind Validity::valid
    """.split()
#: Members of classes that python/src makes: methods, methods that take long and release Python's lock, properties.
CLASSES = {
    "Bodies": {"method": "add step update_after_edit checkpoint restore predicted_state id first_particle particle_count "
        "fits surface energy rigid_motion_of audit state_hash",
        "property": "size options steps particles positions masses radii body_of statuses counters"},
    "Catheter": {"method": "frames audit state_hash step update_after_edit checkpoint restore",
        "property": "inserted measured_length total_length turned entry direction particles options"},
    "CellComplex": {"method": "vertices previous_corners",
        "property": "positions previous_positions point_count simplex_count steiner_point_count bytes "
        "invalid_cells"},
    "CombinatorialMap": {"method": "phi1 phi_1 origin face flat handle may_touch_wall",
        "long_method": "wall_face_count cells",
        "property": "patch_names dimension vertex_count bytes"},
    "ComplexEdit": {"method": "refused_cells"},
    "Deformation": {"method": "add_pull"},
    "Environment": {"method": "awaits_advance",
        "long_method": "validity first_inversion",
        "property": "positions edit_count last_edit"},
    "Particles": {"method": "remove truncate reorder",
        "long_method": "selected",
        "property": "size"},
    "SharedParticles": {"property": "size width ids"},
    "SharedEnvironment": {"method": "move"},
    "Simulation": {"method": "set_statistics add_body set_events set_remeshing set_adaptive_subdivision repair adapt step "
        "checkpoint restore go_to steer",
        "long_method": "totals_of_all alive body_summaries solid_summaries catheter_summaries energy audit "
        "state_hash",
        "property": "particles ids velocities statuses contact_counts radii diameters densities "
        "charges_per_mass bodies_step catheter_count solids_step statistics statistics_options totals seconds_solids event_log options time steps "
        "deforms"},
    "SolidSet": {"method": "add remove update_after_edit set_inverse_masses restore checkpoint",
        "long_method": "audit",
        "property": "size positions first_vertices particles stuck"},
    "WallHits": {"method": "update_after_edit by_patch"},
    "Surface": {"method": "set_free place",
        "property": "positions"},
    "Transaction": {"method": "add_vertex set_free note_merged added removed marked merged",
        "property": "created_count"},
    "VectorField": {"property": "steady rest"},
}
CONSTANTS_BY_HAND = {"cell_type_names", "deformation_kinds"}
HEADERS_BY_HAND = {"storage.hpp"}  # C++ only
FILES = 3
HEAD = """// Written by tools/make_bindings.py: records of the public headers.
#include "dartcast/dartcast.hpp"
#include "support/members.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace dartcast::python::records {
"""


def python_text(text: str) -> str:
    """A comment in the words of Python."""
    for pattern, words in WORDS:
        text = re.sub(pattern, words, text)
    return text


def quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def arguments(name: read_headers.Name, types: set[str]) -> list[tuple[str, str]]:
    """Names of a function's arguments, and code that makes the default of each, or none. `types`: of the headers."""
    inner = re.sub(r"\[ \[.*?\] \] ", "", name.declaration).partition(f"{name.name.rpartition('::')[2]} (")[2]
    depth, words, parts = 1, [], []
    for word in inner.split():
        depth += (word in "([{<") - (word in ")]}>")
        if depth == 0 or (depth == 1 and word == ","):
            parts.append(" ".join(words))
            words = []
            if depth == 0:
                break
        else:
            words.append(word)
    found = []
    for part in filter(None, parts):
        declared, _, value = part.partition(" = ")
        kind, _, last = declared.rpartition(" ")
        kind = re.sub(r"^const | &$", "", kind)
        castable = kind in types or re.fullmatch(r"bool|double|unsigned|std :: (size_t|uint\d+_t|string)", kind)
        code = f"[] {{ return pybind11::cast({kind}({value.strip('{}')})); }}" if value and castable else ""
        if value and re.fullmatch(r"std :: span < const std :: uint\d+_t >", kind):
            code = "[] { return pybind11::object(pybind11::tuple()); }"
        found.append((last + "_" if keyword.iskeyword(last) else last, code))
    return found


def docs(names: list[read_headers.Name]) -> str:
    """The table of docstrings and arguments. Arguments of overloads are left out: python/src names them."""
    all_of: dict[str, list[read_headers.Name]] = collections.defaultdict(list)
    for name in names:
        all_of[name.name].append(name)
    types = {name.name for name in names if name.kind in ("class", "enum")}
    tables, entries = [], []
    for i, name in enumerate(sorted(all_of)):
        text = "\n\n".join(dict.fromkeys(n.doc for n in all_of[name] if n.doc))
        given = arguments(all_of[name][0], types) if [n.kind for n in all_of[name]] == ["function"] else []
        if given:
            values = ", ".join(f'{{"{argument}", {code or "nullptr"}}}' for argument, code in given)
            tables.append(f"constexpr Argument arguments_{i}[] = {{{values}}};\n")
        entries.append(f"{{{quoted(name)}, {quoted(python_text(text))}{f', arguments_{i}' if given else ''}}},\n")
    return "".join(tables) + "constexpr Entry entries[] = {\n" + "".join(entries) + "};\n"


def rows() -> tuple[str, str]:
    """The structs of rows with the functions that fill them; and a function that makes their dtypes known. Gaps in a row
    stay zero."""
    text, known = "", ""
    for of, columns in ROWS.items():
        parts = [column.partition(":") for column in columns.split()]
        values = {name: code if "(" in code else f"column(x.{code or name})" for name, _, code in parts}
        x = f"std::declval<const {of}&>()"
        fields = "".join(f"  decltype({re.sub(r'[(]x[.]', f'({x}.', code)}) {name};\n" for name, code in values.items())
        text += f"struct {of}Row {{\n{fields}}};\n"
        sets = [f"fill(x.{name}, r.{name})" if code.startswith("row_of") else f"r.{name} = {code}"
                for name, code in values.items()]
        text += f"inline void fill(const {of}& x, {of}Row& r) {{\n  {f';{chr(10)}  '.join(sets)};\n}}\n"
        text += f"inline {of}Row row_of(const {of}& x) {{\n  {of}Row r{{}};\n  fill(x, r);\n  return r;\n}}\n"
        known += f"  PYBIND11_NUMPY_DTYPE({of}Row, {', '.join(values)});\n"
    return text, f"void register_rows() {{\n{known}}}\n"


def members() -> str:
    """A function for each class that defines its members."""
    text = ""
    for of, kinds in CLASSES.items():
        said = {name: SAID.get(f"{of}::{name}") for names in kinds.values() for name in names.split()}
        lines = [f'  {kind}(c, "{name}", &{of}::{name}{f", {quoted(said[name])}" if said[name] else ""});\n'
                 for kind, names in kinds.items() for name in names.split()]
        text += f"template <class C>\nvoid members_of_{of}(C& c) {{\n{''.join(lines)}}}\n"
    return text


class Binder:
    """Writes the functions that bind the names of the headers."""

    def __init__(self, names: list[read_headers.Name]) -> None:
        self.names = names
        self.known = {name.name: name for name in names}
        self.parts: dict[tuple[str, str], list[str]] = collections.defaultdict(list)
        for name in names:
            if name.kind == "class":
                self.parts[name.name, "class"] = [name.declaration.split()[0]]
            elif "::" in name.name and name.name not in MEMBERS_BY_HAND:
                outer, _, last = name.name.rpartition("::")
                self.parts[outer, name.kind].append(last)

    def is_record(self, name: str) -> bool:
        return self.parts.get((name, "class")) == ["struct"] and not BY_HAND & set(name.split("::"))

    def record(self, name: str) -> list[str]:
        """Statements that bind a record. A variable holds its class, to which records in it belong."""
        outer, _, short = name.rpartition("::")
        scope = "m" if not outer else class_of(outer) if self.is_record(outer) else f'm.attr("{outer}")'
        other = f', "{name}"' if outer else ""
        fields = "".join(f'\n      .field("{m}_", &{name}::{m}, "{m}")' if keyword.iskeyword(m) else
                         f'\n      .field("{m}", &{name}::{m})' for m in self.parts[name, "member"])
        lines = [f'auto {class_of(name)} = Record<{name}>({scope}, "{short}"{other}){fields}.finish();']
        for constant in self.parts[name, "constant"]:
            python = constant if constant == "kind" else constant.upper()
            lines.append(f'{class_of(name)}.attr("{python}") = pybind11::cast({name}::{constant});')
        for function in dict.fromkeys(self.parts[name, "function"]):
            full = f"{name}::{function}"
            if full in METHODS:
                python = "__iadd__" if function == "operator+=" else function
                other = 'pybind11::arg("other"), ' if python == "__iadd__" else ""
                said = SAID.get(full, "")
                lines.append(f'{class_of(name)}.def("{python}", &{full}, {other}about("{full}", "{said}"));')
            elif full in PROPERTIES:
                lines.append(f'{class_of(name)}.def_property_readonly("{function}", &{full}, about("{full}"));')
        return lines

    def bind(self, name: read_headers.Name) -> list[str]:
        if name.kind == "enum":
            values = ", ".join(f'{{"{v.upper()}", {name.name}::{v}}}' for v in self.parts[name.name, "value"])
            return [f'bind_enum<{name.name}>(m, "{name.name}", {{{values}}});']
        if name.kind == "constant" and "::" not in name.name and name.name not in CONSTANTS_BY_HAND:
            return [f'm.attr("{name.name.upper()}") = pybind11::cast({name.name});']
        if name.name in READ_ONLY and name.kind == "class":
            return self.read_only(name.name)
        return self.record(name.name) if self.is_record(name.name) else []

    def read_only(self, name: str) -> list[str]:
        """Statements that bind a struct of READ_ONLY. The columns of an array are told with what the headers say."""
        members = []
        for member in self.parts[name, "member"]:
            full = f"{name}::{member}"
            if member in READ_ONLY[name].split():
                of = re.search(r"vector < (\w+) >", self.known[full].declaration)[1]
                columns = [c.partition(":")[0] for c in ROWS[of].split()]
                told = [self.known.get(f"{of}::{c}") for c in columns]
                text = "\n".join([f"A structured array, a row for each {of}:", *(
                    f"- {c}{f': {python_text(k.doc)}' if k and k.doc else ''}" for c, k in zip(columns, told))])
                members.append(f'\n      .rows("{member}", &{full}, {quoted(text)})')
            else:
                members.append(f'\n      .member("{member}", &{full})')
        return [f'ReadOnly<{name}>(m, "{name}")' + "".join(members) + ";"]

    def is_nested(self, name: read_headers.Name) -> bool:
        """Whether its class is none of the records, so that it must be there before."""
        outer = name.name.rpartition("::")[0]
        return outer != "" and not self.is_record(outer)

    def files(self, out: pathlib.Path) -> dict[pathlib.Path, str]:
        """A function for each header, in a few files of the same size: they compile at the same time."""
        functions: dict[str, list[str]] = {}
        for nested in (False, True):
            for name in (n for n in self.names if self.is_nested(n) == nested):
                stem = "in_classes" if nested else pathlib.Path(name.header).stem
                functions.setdefault(stem, []).extend(self.bind(name))
        for name in FUNCTIONS:
            functions["in_classes"].append(
                f'function(m, "{name}", &dartcast::{name});' if arguments(self.known[name], set()) else
                f'm.def("{name}", &dartcast::{name}, pybind11::call_guard<pybind11::gil_scoped_release>(), about("{name}"));')
        functions = {stem: lines for stem, lines in functions.items() if lines}
        files: list[list[str]] = [[] for _ in range(FILES)]
        for stem, lines in functions.items():
            min(files, key=lambda texts: sum(map(len, texts))).append(
                f"void bind_{stem}(pybind11::module_& m) {{\n  " + "\n  ".join(lines) + "\n}\n")
        calls = [stem for stem in functions if stem != "in_classes"]
        files[0] += [f"void bind_{stem}(pybind11::module_& m);\n" for stem in calls]
        files[0] += ["void bind(pybind11::module_& m) {\n", *(f"  bind_{stem}(m);\n" for stem in calls), "}\n"]
        return {out / f"records_{i}.cpp": HEAD + "".join(texts) + "}\n" for i, texts in enumerate(files)}


def class_of(record: str) -> str:
    return record.replace("::", "_") + "_class"


def write(path: pathlib.Path, content: str) -> None:
    """Leaves a file that is right as it is, so that nothing is compiled again."""
    if not path.exists() or path.read_text(encoding="utf-8") != content:
        path.write_text(content, encoding="utf-8")


def main() -> int:
    headers, out = map(pathlib.Path, sys.argv[1:3])
    names = read_headers.read_headers(headers)
    out.mkdir(parents=True, exist_ok=True)
    write(out / "docs.inl", docs(names))
    names = [n for n in names if n.header not in HEADERS_BY_HAND]
    write(out / "enums.inl", "".join(f"DARTCAST_ENUM({n.name})\n" for n in names if n.kind == "enum"))
    structs, known = rows()
    write(out / "rows.inl", structs)
    write(out / "members.inl", members())
    write(out / "rows.cpp", f'#include "support/rows.hpp"\n\nnamespace dartcast::python {{\n{known}}}\n')
    for path, content in Binder(names).files(out).items():
        write(path, content)
    return 0


if __name__ == "__main__":
    sys.exit(main())
