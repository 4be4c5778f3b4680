// Binds dartcast/contact.hpp. The contacts of a batch are a structured array, and so are their walls.
#include "dartcast/contact.hpp"

#include <cstring>
#include <vector>

#include "bind.hpp"
#include "contact_arrays.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

struct ContactRow {
  std::uint32_t particle;
  std::uint8_t kind;
  bool last;
  std::uint16_t patch;
  double time_of_impact;
  double point[3];
  double normal[3];
  double wall_displacement[3];
  double displacement[3];
  double unused[3];
  std::uint32_t first_wall;
  std::uint32_t wall_count;
  std::uint32_t earlier;
  std::uint32_t together;
  std::uint32_t dart_cell;
  std::uint16_t dart;
};

struct WallRow {
  std::uint32_t cell;
  std::uint16_t face;
  std::uint16_t triangle;
  std::uint16_t patch;
  double normal[3];
};

void put(const Vec3& from, double (&to)[3]) { std::memcpy(to, &from, sizeof to); }

ContactRow row_of(const Contact& c, const WallHit& wall) {
  ContactRow row{};
  row.particle = c.particle;
  row.kind = static_cast<std::uint8_t>(c.kind);
  row.last = c.last;
  row.patch = wall.patch.value;
  row.time_of_impact = c.time_of_impact;
  put(c.point, row.point);
  put(wall.normal, row.normal);
  put(c.wall_displacement, row.wall_displacement);
  put(c.displacement, row.displacement);
  put(c.unused, row.unused);
  row.first_wall = c.first_wall;
  row.wall_count = c.wall_count;
  row.earlier = c.earlier;
  row.together = c.together;
  row.dart_cell = c.dart.cell.value;
  row.dart = c.dart.number;
  return row;
}

}  // namespace

py::array contact_array(const ContactList& list) {
  std::vector<ContactRow> rows;
  rows.reserve(list.contacts.size());
  for (const Contact& c : list.contacts) rows.push_back(row_of(c, list.walls[c.first_wall]));
  return array_of(std::move(rows));
}

py::array wall_array(const std::vector<WallHit>& walls) {
  std::vector<WallRow> rows(walls.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].cell = walls[i].face.cell.value;
    rows[i].face = walls[i].face.face;
    rows[i].triangle = walls[i].triangle;
    rows[i].patch = walls[i].patch.value;
    put(walls[i].normal, rows[i].normal);
  }
  return array_of(std::move(rows));
}

void bind_contact(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(ContactRow, particle, kind, last, patch, time_of_impact, point, normal, wall_displacement,
                       displacement, unused, first_wall, wall_count, earlier, together, dart_cell, dart);
  PYBIND11_NUMPY_DTYPE(WallRow, cell, face, triangle, patch, normal);
  m.attr("SHARE_TOGETHER") = share_together;
  m.attr("ALONG_SHARE") = along_share;
}

}  // namespace dartcast::python
