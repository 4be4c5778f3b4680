// Reads the table [statistics].
#include <fmt/format.h>

#include "dartcast/error.hpp"
#include "scene/scene_keys.hpp"

namespace dartcast {

namespace {

constexpr std::uint64_t max_id = std::uint64_t{1} << 53U;

// Checked with those before it: the line of the first plane that is wrong is reported.
void read_plane(TomlTable& t, std::vector<SectionPlane>& planes) {
  SectionPlane& plane = planes.emplace_back();
  t.require("name", "a name for the plane, of letters, digits, - and _");
  t.require("point", "a point of the plane");
  t.require("normal", "a vector of any length: forward is where it points to");
  t.get("name", plane.name);
  t.get("point", plane.point);
  t.get("normal", plane.normal);
  t.get("radius", plane.radius, Range::positive);
  t.finish();
  try {
    check(planes);
  } catch (const Error& e) {
    t.fail("name", e.what());
  }
}

void read_pathlines(TomlTable t, StatisticsOptions& options) {
  const bool every = t.get("every", options.pathlines_every, 1, max_id);
  if (!t.get("ids", options.pathlines_of, 0, max_id) && !every)
    t.fail("", "give every = N for each N-th particle, or ids = [...]");
  t.finish();
}

void read_cells(TomlTable t, StatisticsOptions& options) {
  std::vector<std::string>& quantities = options.cells;
  t.require("quantities", "some of the quantities that docs/scene.md lists");
  t.get("quantities", quantities);
  try {
    check_cell_quantities(quantities);
  } catch (const Error& e) {
    t.fail("quantities", e.what());
  }
  t.get("every", options.cells_every, 1, max_id);
  t.finish();
}

void read_classes(TomlTable t, StatisticsOptions& options) {
  t.require("of", "\"group\", \"diameter\", or a name of user_data");
  t.get("of", options.classes_of);
  if (!t.get("bounds", options.class_bounds) && options.classes_of != group_number)
    t.fail("", "give bounds = [...], the values between the classes");
  t.finish();
}

}  // namespace

StatisticsScene read_statistics(TomlTable t) {
  StatisticsScene scene;
  t.get("hits", scene.options.hits);
  if (t.get("impacts", scene.options.impacts) && scene.options.impacts && !scene.options.hits)
    t.fail("impacts", "impacts are sums of hits: set hits = true");
  t.get("residence", scene.options.residence);
  for (TomlTable& plane : t.tables("plane")) read_plane(plane, scene.options.planes);
  t.get("crossings", scene.crossings);
  if (scene.crossings && scene.options.planes.empty())
    t.fail("crossings", "crossings = true: there is no plane; add [[statistics.plane]]");
  if (t.has("cells")) read_cells(t.table("cells"), scene.options);
  if (t.has("classes")) read_classes(t.table("classes"), scene.options);
  if (t.has("pathlines")) read_pathlines(t.table("pathlines"), scene.options);
  t.finish();
  return scene;
}

}  // namespace dartcast
