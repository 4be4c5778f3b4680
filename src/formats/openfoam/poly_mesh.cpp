// Reads the files of a polyMesh folder: points and faces, then what the faces bound, then patches and zones.
#include "formats/openfoam/poly_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

void read_faces(const fs::path& folder, std::uint64_t max_memory, PolyMesh& mesh) {
  FoamFile file(folder, "faces", max_memory);
  mesh.faces = file.lists("faces", mesh.points.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f].size() < 3) file.fail(fmt::format("face {} has {} corners", f, mesh.faces[f].size()));
  }
}

void read_owners(const fs::path& folder, std::uint64_t max_memory, PolyMesh& mesh) {
  const std::size_t n = mesh.faces.size();
  FoamFile owner(folder, "owner", max_memory);
  mesh.owner = owner.labels("owners", n);  // a cell has faces of its own: there are fewer cells than faces
  if (mesh.owner.size() != n) owner.fail(fmt::format("{} owners for {} faces", mesh.owner.size(), n));
  FoamFile neighbour(folder, "neighbour", max_memory);
  mesh.neighbour = neighbour.labels("neighbours", n);
  if (mesh.neighbour.size() > n) neighbour.fail(fmt::format("{} neighbours for {} faces", mesh.neighbour.size(), n));
  for (const auto* list : {&mesh.owner, &mesh.neighbour}) {
    for (const std::uint32_t c : *list) mesh.cells = std::max<std::size_t>(mesh.cells, c + std::size_t{1});
  }
}

PolyPatchRange read_patch(FoamFile& file) {
  PolyPatchRange range;
  std::int64_t size = -1;
  std::int64_t first = -1;
  range.patch.name = file.word("the name of a patch");
  file.expect('{', fmt::format("behind the name {}", range.patch.name));
  while (!file.take('}')) {
    const std::string key(file.word("a key of a patch"));
    if (key == "type") range.patch.type = file.word("the type of a patch");
    if (key == "neighbourPatch") range.patch.neighbour = file.word("the name of a patch");
    if (key == "referPatch") range.patch.refers = file.word("the name of a patch");
    if (key == "nFaces") size = file.integer("the number of faces", 0, no_label_limit);
    if (key == "startFace") first = file.integer("the first face", 0, no_label_limit);
    file.skip_entry();
  }
  if (size < 0 || first < 0) file.fail(fmt::format("the patch {} has no nFaces or no startFace", range.patch.name));
  range.first = static_cast<std::size_t>(first);
  range.size = static_cast<std::size_t>(size);
  return range;
}

template <class Take>
void for_each_patch(FoamFile& file, Take&& take) {
  if (file.next() != '(') file.integer("the number of patches", 0, no_label_limit);
  file.expect('(', "before the patches");
  while (!file.take(')')) take(read_patch(file));
}

// Faces behind those inside are in one patch each.
void read_boundary(const fs::path& folder, std::uint64_t max_memory, PolyMesh& mesh) {
  const std::size_t n = mesh.faces.size();
  const std::size_t inside = mesh.neighbour.size();
  mesh.patch.assign(n, none);
  mesh.neighbour.resize(n, none);
  FoamFile file(folder, "boundary", max_memory);
  for_each_patch(file, [&](PolyPatchRange range) {
    const auto [first, size] = std::pair{range.first, range.size};
    if (size > 0 && (first < inside || first > n || size > n - first))
      file.fail(fmt::format("the patch {} has the faces {} to {}; those of the boundary are {} to {}", range.patch.name,
                            first, first + size - 1, inside, n - 1));
    for (std::size_t f = first; f < first + size; ++f) {
      if (mesh.patch[f] != none)
        file.fail(
            fmt::format("face {} is in the patches {} and {}", f, mesh.patches[mesh.patch[f]].name, range.patch.name));
      mesh.patch[f] = static_cast<std::uint32_t>(mesh.patches.size());
    }
    mesh.patches.push_back(std::move(range.patch));
  });
  const auto without = std::find(mesh.patch.begin() + static_cast<std::ptrdiff_t>(inside), mesh.patch.end(), none);
  if (without != mesh.patch.end())
    file.fail(fmt::format("face {} is on the boundary, but in no patch", without - mesh.patch.begin()));
}

// `key`: cellLabels or faceLabels.
std::vector<PolyZone> read_zones(const fs::path& folder, std::uint64_t max_memory, std::string_view name,
                                 std::string_view key, std::size_t limit) {
  if (!has_foam_file(folder, name)) return {};
  FoamFile file(folder, name, max_memory);
  std::vector<PolyZone> zones;
  if (file.next() == '\0') return zones;
  if (file.next() != '(' && file.integer("the number of zones", 0, no_label_limit) == 0 && file.next() != '(')
    return zones;
  file.expect('(', "before the zones");
  while (!file.take(')')) {
    PolyZone zone;
    zone.name = file.word("the name of a zone");
    file.expect('{', fmt::format("behind the name {}", zone.name));
    while (!file.take('}')) {
      const std::string_view found = file.word("a key of a zone");
      if (found == key) {
        zone.labels = file.labels(key, limit);
        file.expect(';', fmt::format("behind {}", key));
      } else if (found == "flipMap") {
        file.skip_bools();
        file.expect(';', "behind flipMap");
      } else {
        file.skip_entry();
      }
    }
    zones.push_back(std::move(zone));
  }
  return zones;
}

}  // namespace

std::vector<PolyPatchRange> read_poly_patches(const fs::path& folder, std::uint64_t max_memory) {
  FoamFile file(folder, "boundary", max_memory);
  std::vector<PolyPatchRange> patches;
  for_each_patch(file, [&](PolyPatchRange range) { patches.push_back(std::move(range)); });
  return patches;
}

std::vector<Vec3> read_poly_points(const fs::path& folder, std::uint64_t max_memory) {
  FoamFile file(folder, "points", max_memory);
  std::vector<Vec3> points = file.vectors("points");
  if (points.size() >= no_label_limit) file.fail("more than 2^32 - 2 points");
  return points;
}

PolyMesh read_poly_mesh(const fs::path& folder, std::uint64_t max_memory) {
  PolyMesh mesh;
  mesh.points = read_poly_points(folder, max_memory);
  read_faces(folder, max_memory, mesh);
  read_owners(folder, max_memory, mesh);
  read_boundary(folder, max_memory, mesh);
  mesh.cell_zones = read_zones(folder, max_memory, "cellZones", "cellLabels", mesh.cells);
  mesh.face_zones = read_zones(folder, max_memory, "faceZones", "faceLabels", mesh.faces.size());
  return mesh;
}

}  // namespace dartcast
