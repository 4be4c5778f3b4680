// The same random edits on CGAL's linear cell complex: the maps stay isomorphic, component by component, vertices
// included, and faces fall apart at the same vertices.
#include <CGAL/Linear_cell_complex_for_combinatorial_map.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "dartcast/base/error.hpp"
#include "map/edit_meshes.hpp"
#include "map/random_edits.hpp"
#include "tier.hpp"

namespace dartcast {
namespace {

using test::CellBag;
using test::Edit;
using test::EditKind;

using Lcc = CGAL::Linear_cell_complex_for_combinatorial_map<
    3, 3, CGAL::Linear_cell_complex_traits<3, CGAL::Simple_cartesian<double>>>;
using Handle = Lcc::Dart_handle;

Lcc::Point point_of(Vertex v) { return {static_cast<double>(v.value), 0.0, 0.0}; }

std::vector<Dart> darts_of(const Map& map) {
  std::vector<Dart> darts;
  for (const Cell c : map.cells()) {
    for (std::uint16_t d = 0; d < map.shape(c).dart_count(); ++d) darts.push_back({c, d});
  }
  return darts;
}

// The map as a complex of CGAL's, dart by dart; a vertex's number is its x.
std::map<Dart, Handle> copy(const Map& map, Lcc& lcc) {
  std::map<Dart, Handle> handle;
  const std::vector<Dart> darts = darts_of(map);
  for (const Dart d : darts) handle[d] = lcc.create_dart();
  for (const Dart d : darts) {
    lcc.basic_link_beta_1(handle[d], handle[map.phi1(d)]);
    lcc.basic_link_beta_for_involution<2>(handle[d], handle[map.phi2(d)]);
    if (const Dart other = map.phi3(d); other.valid()) lcc.basic_link_beta_for_involution<3>(handle[d], handle[other]);
  }
  for (const Dart d : darts) {
    if (lcc.attribute<0>(handle[d]) == lcc.null_handle)
      lcc.set_vertex_attribute(handle[d], lcc.create_vertex_attribute(point_of(map.origin(d))));
  }
  return handle;
}

// A complex of CGAL's that follows the map edit by edit.
class Mirror {
 public:
  explicit Mirror(const Map& map) : map_(map) {
    for (const auto& [d, handle] : copy(map, lcc_)) {
      if (d.number == 0) volume_[d.cell.value] = handle;
    }
  }

  // Before the edit: its darts here.
  void find(const Edit& e) {
    darts_.clear();
    for (const Dart d : e.darts) darts_.push_back(find(d));
    corners_ = e.kind == EditKind::unsew ? corners_of(darts_[0]) : std::vector<std::pair<Handle, Handle>>{};
  }

  // After it.
  void follow(const Edit& e, const EditReport& report) {
    std::set<Handle> touched = touched_by(report);
    apply(e, report);
    for (const CellHandle& h : report.removed) volume_.erase(h.cell.value);
    match(report.added, touched);
  }

  // Every component of the map, from one of its darts.
  void expect_isomorphic() {
    Lcc copied;
    const auto handles = copy(map_, copied);
    ASSERT_EQ(copied.number_of_darts(), lcc_.number_of_darts());
    ASSERT_TRUE(lcc_.is_valid());
    std::set<Handle> seen;
    for (const auto& [d, handle] : handles) {
      if (seen.contains(handle)) continue;
      for (auto it = copied.darts_of_orbit<1, 2, 3>(handle).begin(); it.cont(); ++it) seen.insert(it);
      const Handle here = find(d);
      ASSERT_TRUE(copied.are_cc_isomorphic(handle, lcc_, here, false, false, true));
    }
  }

 private:
  Vertex vertex(Handle h) const { return Vertex(static_cast<std::uint32_t>(lcc_.point(h).x())); }

  Handle find(Dart d) {
    const Vertex u = map_.origin(d);
    const Vertex v = map_.origin(map_.phi1(d));
    for (auto it = lcc_.darts_of_orbit<1, 2>(volume_.at(d.cell.value)).begin(); it.cont(); ++it) {
      if (vertex(it) == u && vertex(lcc_.beta<1>(it)) == v) return it;
    }
    ADD_FAILURE() << "no such dart in the mirror";
    return {};
  }

  // Both sides' darts at each corner of a face.
  std::vector<std::pair<Handle, Handle>> corners_of(Handle face) {
    std::vector<std::pair<Handle, Handle>> corners;
    for (auto it = lcc_.darts_of_orbit<1>(face).begin(); it.cont(); ++it) {
      if (!lcc_.is_free<3>(it)) corners.emplace_back(it, lcc_.beta<3, 1>(it));
    }
    return corners;
  }

  std::set<Handle> touched_by(const EditReport& report) {
    std::set<Handle> touched;
    for (const CellHandle& h : report.removed) {
      for (auto it = lcc_.darts_of_orbit<1, 2>(volume_.at(h.cell.value)).begin(); it.cont(); ++it) touched.insert(it);
    }
    return touched;
  }

  void apply(const Edit& e, const EditReport& report) {
    switch (e.kind) {
      case EditKind::split_edge: lcc_.insert_point_in_cell<1>(darts_[0], point_of(report.born.at(0).vertex)); break;
      case EditKind::split_face: lcc_.insert_cell_1_in_cell_2(darts_[0], darts_[1]); break;
      case EditKind::split_cell: lcc_.insert_cell_2_in_cell_3(darts_.begin(), darts_.end()); break;
      case EditKind::merge_cells: remove<2>(); break;
      case EditKind::merge_faces: remove<1>(); break;
      case EditKind::merge_edges: remove<0>(); break;
      case EditKind::sew: sew(); break;
      case EditKind::unsew: unsew(report); break;
      case EditKind::mark: break;
      case EditKind::remove: remove<3>(); break;
    }
  }

  template <unsigned dimension>
  void remove() {
    ASSERT_TRUE(lcc_.is_removable<dimension>(darts_[0]));
    lcc_.remove_cell<dimension>(darts_[0]);
  }

  void sew() {
    ASSERT_TRUE(lcc_.is_sewable<3>(darts_[0], darts_[1]));
    std::vector<std::pair<Handle, Vertex>> survivors;
    Handle a = darts_[0];
    Handle b = lcc_.beta<1>(darts_[1]);
    do {
      survivors.emplace_back(a, std::min(vertex(a), vertex(b)));
      a = lcc_.beta<1>(a);
      b = lcc_.beta<0>(b);
    } while (a != darts_[0]);
    lcc_.sew<3>(darts_[0], darts_[1]);
    for (const auto& [h, v] : survivors) lcc_.point(h) = point_of(v);
  }

  void unsew(const EditReport& report) {
    lcc_.unsew<3>(darts_[0]);
    std::size_t parted = 0;
    for (const auto& [here, beyond] : corners_) {
      const auto born = std::find_if(report.born.begin(), report.born.end(),
                                     [&, v = vertex(here)](const BornVertex& b) { return b.from == v; });
      ASSERT_EQ(lcc_.vertex_attribute(here) != lcc_.vertex_attribute(beyond), born != report.born.end());
      if (born == report.born.end()) continue;
      ++parted;
      lcc_.point(beyond) = point_of(born->vertex);
    }
    ASSERT_EQ(parted, report.born.size());
  }

  using Loops = std::set<std::vector<std::uint32_t>>;  // from the lowest vertex

  static void add_loop(Loops& loops, std::vector<std::uint32_t> loop) {
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    loops.insert(std::move(loop));
  }

  Loops loops_of(Handle volume) {
    Loops loops;
    for (auto it = lcc_.darts_of_orbit<1, 2>(volume).begin(); it.cont(); ++it) {
      std::vector<std::uint32_t> loop;
      for (auto k = lcc_.darts_of_orbit<1>(it).begin(); k.cont(); ++k) loop.push_back(vertex(k).value);
      add_loop(loops, loop);
    }
    return loops;
  }

  Loops loops_of(Cell c) const {
    Loops loops;
    const CellView v = map_.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      std::vector<std::uint32_t> loop;
      for (const std::uint16_t k : v.shape().corners(f)) loop.push_back(v.vertex(k).value);
      add_loop(loops, loop);
    }
    return loops;
  }

  // Finds the volumes of new cells among those that hold a touched dart.
  void match(const std::vector<Cell>& added, const std::set<Handle>& touched) {
    std::map<Loops, Handle> volumes;
    std::set<Handle> seen;
    for (const Handle h : touched) {
      if (!lcc_.is_dart_used(h) || seen.contains(h)) continue;
      for (auto it = lcc_.darts_of_orbit<1, 2>(h).begin(); it.cont(); ++it) seen.insert(it);
      volumes[loops_of(h)] = h;
    }
    for (const Cell c : added) {
      const auto found = volumes.find(loops_of(c));
      ASSERT_NE(found, volumes.end()) << "a cell has no like in the mirror";
      volume_[c.value] = found->second;
    }
  }

  const Map& map_;
  Lcc lcc_;
  std::unordered_map<std::uint32_t, Handle> volume_;  // a dart of each cell
  std::vector<Handle> darts_;                         // of the edit
  std::vector<std::pair<Handle, Handle>> corners_;
};

class EditsAndCgal : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(Map, EditsAndCgal, testing::ValuesIn(test::edit_meshes()),
                         [](const auto& i) { return std::string(i.param.name); });

TEST_P(EditsAndCgal, StayIsomorphic) {
  Map map(GetParam().make());
  CellBag bag(map);
  Mirror mirror(map);
  Random random(23);
  Transaction t(map);
  const std::size_t usual = bag.size();
  const int count = test::scaled(10000, 1000000) / static_cast<int>(test::edit_meshes().size());
  for (int edits = 0; edits < count;) {
    const Edit edit = draw_edit(map, draw_kind(bag, usual, random), bag.draw(map, random), bag, random);
    mirror.find(edit);
    try {
      apply(t, edit);
    } catch (const Error&) {
      continue;
    }
    const EditReport report = t.commit();
    bag.update(report);
    mirror.follow(edit, report);
    ASSERT_FALSE(HasFailure()) << "edit " << edits << " of kind " << static_cast<int>(edit.kind);
    if (++edits % 200 != 0 && edits != count) continue;
    mirror.expect_isomorphic();
    ASSERT_FALSE(HasFailure()) << "after " << edits << " edits";
  }
}

}  // namespace
}  // namespace dartcast
