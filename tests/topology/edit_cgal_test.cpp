// The same random edits on CGAL's linear cell complex: the maps stay isomorphic, component by component, vertices
// included, and faces fall apart at the same vertices.
#include <CGAL/Linear_cell_complex_for_combinatorial_map.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "dartcast/error.hpp"
#include "support/darts.hpp"
#include "support/edit_meshes.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::edit_cgal_test {

using test::all_darts;
using test::CellBag;
using test::Edit;
using test::EditKind;

template <unsigned dimension>
using LccOf = CGAL::Linear_cell_complex_for_combinatorial_map<
    dimension, dimension, CGAL::Linear_cell_complex_traits<dimension, CGAL::Simple_cartesian<double>>>;

template <unsigned dimension>
auto point_of(Vertex v) {
  if constexpr (dimension == 2)
    return typename LccOf<2>::Point(v.value, 0.0);
  else
    return typename LccOf<3>::Point(v.value, 0.0, 0.0);
}

// The map as a complex of CGAL's, dart by dart; a vertex's number is its x.
template <unsigned dimension>
auto copy(const CombinatorialMap& map, LccOf<dimension>& lcc) {
  std::map<Dart, typename LccOf<dimension>::Dart_handle> handle;
  const std::vector<Dart> darts = all_darts(map);
  for (const Dart d : darts) handle[d] = lcc.create_dart();
  for (const Dart d : darts) {
    lcc.basic_link_beta_1(handle[d], handle[map.phi1(d)]);
    if (const Dart other = map.phi2(d); other.valid())
      lcc.template basic_link_beta_for_involution<2>(handle[d], handle[other]);
    if constexpr (dimension == 3) {
      if (const Dart other = map.phi3(d); other.valid())
        lcc.template basic_link_beta_for_involution<3>(handle[d], handle[other]);
    }
  }
  for (const Dart d : darts) {
    if (lcc.template attribute<0>(handle[d]) == lcc.null_handle)
      lcc.set_vertex_attribute(handle[d], lcc.create_vertex_attribute(point_of<dimension>(map.origin(d))));
  }
  return handle;
}

// A complex of CGAL's that follows the map edit by edit.
template <unsigned dimension>
class Mirror {
  using Lcc = LccOf<dimension>;
  using Handle = typename Lcc::Dart_handle;

 public:
  explicit Mirror(const CombinatorialMap& map) : map_(map) {
    for (const auto& [d, handle] : copy<dimension>(map, lcc_)) {
      if (d.number == 0) cell_[d.cell.value] = handle;
    }
  }

  // Before the edit: its darts here.
  void find(const Edit& e) {
    darts_.clear();
    for (const Dart d : e.darts) darts_.push_back(find(d));
    corners_ = e.kind == EditKind::unsew ? corners_of(darts_[0]) : std::vector<std::pair<Handle, Handle>>{};
  }

  // After it.
  void update_after_edit(const Edit& e, const EditReport& report) {
    std::set<Handle> touched = touched_by(report);
    apply(e, report);
    for (const CellHandle& h : report.removed) cell_.erase(h.cell.value);
    match(report.added, touched);
  }

  // Every component of the map, from one of its darts.
  void expect_isomorphic() {
    Lcc copied;
    const auto handles = copy<dimension>(map_, copied);
    ASSERT_EQ(copied.number_of_darts(), lcc_.number_of_darts());
    ASSERT_TRUE(lcc_.is_valid());
    std::set<Handle> seen;
    for (const auto& [d, handle] : handles) {
      if (seen.contains(handle)) continue;
      for (auto it = copied.template darts_of_cell<dimension + 1>(handle).begin(); it.cont(); ++it) seen.insert(it);
      const Handle here = find(d);
      ASSERT_TRUE(copied.are_cc_isomorphic(handle, lcc_, here, false, false, true));
    }
  }

 private:
  Vertex vertex(Handle h) const { return Vertex(static_cast<std::uint32_t>(lcc_.point(h).x())); }

  Handle find(Dart d) {
    const Vertex u = map_.origin(d);
    const Vertex v = map_.origin(map_.phi1(d));
    for (auto it = lcc_.template darts_of_cell<dimension>(cell_.at(d.cell.value)).begin(); it.cont(); ++it) {
      if (vertex(it) == u && vertex(lcc_.template beta<1>(it)) == v) return it;
    }
    ADD_FAILURE() << "no such dart in the mirror";
    return {};
  }

  // Both sides' darts at each corner of a face.
  std::vector<std::pair<Handle, Handle>> corners_of(Handle face) {
    std::vector<std::pair<Handle, Handle>> corners;
    for (const Handle h : sides_of(face)) {
      const Handle next = lcc_.template beta<1>(h);
      if (lcc_.template is_free<dimension>(h)) continue;
      corners.emplace_back(h, lcc_.template beta<dimension, 1>(h));
      if (dimension == 2) corners.emplace_back(next, lcc_.template beta<2>(h));
    }
    return corners;
  }

  // The darts of what cells are sewn along: a face, in the plane an edge.
  std::vector<Handle> sides_of(Handle face) {
    if (dimension == 2) return {face};
    std::vector<Handle> darts;
    for (auto it = lcc_.template darts_of_orbit<1>(face).begin(); it.cont(); ++it) darts.push_back(it);
    return darts;
  }

  std::set<Handle> touched_by(const EditReport& report) {
    std::set<Handle> touched;
    for (const CellHandle& h : report.removed) {
      for (auto it = lcc_.template darts_of_cell<dimension>(cell_.at(h.cell.value)).begin(); it.cont(); ++it)
        touched.insert(it);
    }
    return touched;
  }

  void apply(const Edit& e, const EditReport& report) {
    switch (e.kind) {
      case EditKind::split_edge:
        lcc_.template insert_point_in_cell<1>(darts_[0], point_of<dimension>(report.created.at(0).vertex));
        break;
      case EditKind::split_face: lcc_.insert_cell_1_in_cell_2(darts_[0], darts_[1]); break;
      case EditKind::split_cell:
        if constexpr (dimension == 3) lcc_.insert_cell_2_in_cell_3(darts_.begin(), darts_.end());
        break;
      case EditKind::merge_cells: remove<dimension - 1>(); break;
      case EditKind::merge_faces: remove<1>(); break;
      case EditKind::merge_edges: remove<0>(); break;
      case EditKind::sew: sew(); break;
      case EditKind::unsew: unsew(report); break;
      case EditKind::mark: break;
      case EditKind::remove: remove<dimension>(); break;
    }
  }

  template <unsigned of>
  void remove() {
    ASSERT_TRUE(lcc_.template is_removable<of>(darts_[0]));
    lcc_.template remove_cell<of>(darts_[0]);
  }

  void sew() {
    ASSERT_TRUE(lcc_.template is_sewable<dimension>(darts_[0], darts_[1]));
    std::vector<std::pair<Handle, Vertex>> survivors;
    const auto survives = [&](Handle a, Handle b) { survivors.emplace_back(a, std::min(vertex(a), vertex(b))); };
    if (dimension == 2) {
      survives(darts_[0], lcc_.template beta<1>(darts_[1]));
      survives(lcc_.template beta<1>(darts_[0]), darts_[1]);
    } else {
      Handle b = lcc_.template beta<1>(darts_[1]);
      for (const Handle a : sides_of(darts_[0])) {
        survives(a, b);
        b = lcc_.template beta<0>(b);
      }
    }
    lcc_.template sew<dimension>(darts_[0], darts_[1]);
    for (const auto& [h, v] : survivors) lcc_.point(h) = point_of<dimension>(v);
  }

  void unsew(const EditReport& report) {
    lcc_.template unsew<dimension>(darts_[0]);
    std::size_t parted = 0;
    for (const auto& [here, beyond] : corners_) {
      const auto created = std::find_if(report.created.begin(), report.created.end(),
                                        [&, v = vertex(here)](const CreatedVertex& b) { return b.from == v; });
      ASSERT_EQ(lcc_.vertex_attribute(here) != lcc_.vertex_attribute(beyond), created != report.created.end());
      if (created == report.created.end()) continue;
      ++parted;
      lcc_.point(beyond) = point_of<dimension>(created->vertex);
    }
    ASSERT_EQ(parted, report.created.size());
  }

  using Loops = std::set<std::vector<std::uint32_t>>;  // from the lowest vertex; edges in their direction

  static void add_loop(Loops& loops, std::vector<std::uint32_t> loop) {
    if (dimension == 3) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    loops.insert(std::move(loop));
  }

  Loops loops_of(Handle volume) {
    Loops loops;
    for (auto it = lcc_.template darts_of_cell<dimension>(volume).begin(); it.cont(); ++it) {
      std::vector<std::uint32_t> loop;
      for (const Handle k : sides_of(it)) loop.push_back(vertex(k).value);
      if (dimension == 2) loop.push_back(vertex(lcc_.template beta<1>(it)).value);
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
      for (auto it = lcc_.template darts_of_cell<dimension>(h).begin(); it.cont(); ++it) seen.insert(it);
      volumes[loops_of(h)] = h;
    }
    for (const Cell c : added) {
      const auto found = volumes.find(loops_of(c));
      ASSERT_NE(found, volumes.end()) << "a cell has no like in the mirror";
      cell_[c.value] = found->second;
    }
  }

  const CombinatorialMap& map_;
  Lcc lcc_;
  std::unordered_map<std::uint32_t, Handle> cell_;  // a dart of each cell
  std::vector<Handle> darts_;                       // of the edit
  std::vector<std::pair<Handle, Handle>> corners_;
};

template <unsigned dimension>
void stay_isomorphic(const MeshData& mesh, int count) {
  CombinatorialMap map(mesh);
  CellBag bag(map);
  Mirror<dimension> mirror(map);
  Random random(23);
  Transaction t(map);
  const std::size_t usual = bag.size();
  for (int edits = 0; edits < count;) {
    const EditKind kind = draw_kind(bag, usual, random, dimension);
    const Edit edit = draw_edit(map, kind, bag.draw(map, random), bag, random);
    mirror.find(edit);
    try {
      apply(t, edit);
    } catch (const Error&) {
      continue;
    }
    const EditReport report = t.commit();
    bag.update(report);
    mirror.update_after_edit(edit, report);
    ASSERT_FALSE(testing::Test::HasFailure()) << "edit " << edits << " of kind " << static_cast<int>(edit.kind);
    if (++edits % 200 != 0 && edits != count) continue;
    mirror.expect_isomorphic();
    ASSERT_FALSE(testing::Test::HasFailure()) << "after " << edits << " edits";
  }
}

std::string name_of(const testing::TestParamInfo<test::EditMesh>& info) { return info.param.name; }

class EditsAndCgal : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(CombinatorialMap, EditsAndCgal, testing::ValuesIn(test::edit_meshes()), name_of);

TEST_P(EditsAndCgal, StayIsomorphic) { stay_isomorphic<3>(GetParam().make(), test::scaled(1430, 143000)); }

class PlanarEditsAndCgal : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(CombinatorialMap, PlanarEditsAndCgal, testing::ValuesIn(test::planar_edit_meshes()), name_of);

TEST_P(PlanarEditsAndCgal, StayIsomorphic) { stay_isomorphic<2>(GetParam().make(), test::scaled(3400, 340000)); }

}  // namespace dartcast::edit_cgal_test
