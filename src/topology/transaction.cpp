// Transactions: replacements of cells that can be undone, down to the last word of a record.
#include <algorithm>
#include <numeric>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "topology/cell_form.hpp"
#include "topology/replacement.hpp"

namespace dartcast {

Transaction::Transaction(CombinatorialMap& map) : map_(map) { prepare(); }

Transaction::~Transaction() { roll_back(); }

void Transaction::prepare() {
  if (map_.cells_at_.size() == map_.vertex_count_) return;
  map_.cells_at_.assign(map_.vertex_count_, 0);
  for (std::uint32_t number = 0; number <= CombinatorialMap::general_pool; ++number) {
    CombinatorialMap::Pool& pool = map_.pools_[number];
    map_.for_each_cell(number, 0, pool.count, [&](Cell /*c*/, const CellView& view) {
      for (const std::uint32_t v : view.vertices()) ++map_.cells_at_[v];
    });
    if (!pool.source.empty()) continue;
    pool.source.resize(pool.count);
    std::iota(pool.source.begin(), pool.source.end(), 0U);
  }
}

Vertex Transaction::add_vertex(Vertex from, Vertex other) {
  const bool appended = map_.vacant_vertices_.empty();
  if (appended && map_.vertex_count_ + 1 >= Vertex::invalid_value)
    throw EditRefused("the map would have more than 2^32 - 2 vertices: split the scene");
  const Vertex v = appended ? Vertex(static_cast<std::uint32_t>(map_.vertex_count_)) : map_.vacant_vertices_.back();
  created_.push_back({{v, from, other}, appended});
  if (appended) {
    map_.cells_at_.push_back(0);
    ++map_.vertex_count_;
    map_.wall_vertices_.resize(map_.vertex_count_);
  } else {
    map_.vacant_vertices_.pop_back();
    map_.cells_at_[v.value] = 0;
  }
  return v;
}

// Saves a word of a record before it changes.
void Transaction::keep(Cell c, std::size_t offset) {
  const std::size_t at = static_cast<std::size_t>(map_.record(c) - map_.pools_[c.pool()].words.data()) + offset;
  words_.push_back({c.pool(), at, map_.pools_[c.pool()].words[at]});
}

void Transaction::keep_face(CellFace f) {
  const Shape& s = map_.shape(f.cell);
  const std::size_t neighbour = 2U + s.point_count() + f.face;
  keep(f.cell, neighbour);
  keep(f.cell, f.cell.pool() == CombinatorialMap::general_pool ? neighbour + s.face_count() : 1);
}

// Sets the key of a draft's shape in the general pool. Completes the record's vertices: corners, Steiner points of
// faces, that of the cell.
void Transaction::set_key(const CellDraft& draft, const DraftForm& form, std::vector<std::uint32_t>& vertices) {
  key_.corner_count = static_cast<std::uint16_t>(vertices.size());
  key_.apex = lowest_corner(vertices);
  key_.faces.resize(draft.faces.size());
  std::span<const std::uint16_t> local = form.local;
  for (std::size_t f = 0; f < draft.faces.size(); ++f) {
    const DraftFace& face = draft.faces[f];
    set_from_lowest(key_.faces[f].corners, local.first(face.corners.size()), form.corners);
    key_.faces[f].has_point = face.point.valid();
    if (face.point.valid()) vertices.push_back(face.point.value);
    local = local.subspan(face.corners.size());
  }
  key_.has_point = draft.point.valid();
  if (key_.has_point) vertices.push_back(draft.point.value);
}

void Transaction::count_vertices(Cell c, bool more) {
  for (const std::uint32_t v : map_.view(c).vertices()) map_.cells_at_[v] += more ? 1U : ~0U;
}

std::vector<Cell> Transaction::replace(std::span<const Cell> removed, std::span<const CellDraft> drafts) {
  const Replacement plan = plan_replacement(map_, removed, drafts);
  const Savepoint before = savepoint();
  try {
    for (const Cell c : plan.removed) take_away(c);
    for (const CellFace f : plan.opened) {
      keep_face(f);
      map_.set_neighbour(f, {});
      map_.set_wall(f, true);
    }
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < drafts.size(); ++i) cells.push_back(put(drafts[i], plan.forms[i]));
    link(plan, cells);
    return cells;
  } catch (...) {
    roll_back(before);
    throw;
  }
}

// The record stays as it is until the commit, except for the marks that make handles stale.
void Transaction::take_away(Cell c) {
  removed_.push_back(c);
  count_vertices(c, false);
  keep(c, 0);
  keep(c, 1);
  std::uint32_t* word = map_.record(c);
  word[1] |= CombinatorialMap::vacant_bit;
  if (c.pool() == CombinatorialMap::general_pool) {
    word[1] = (word[1] & 0xffff0000U) | ((word[1] + 1U) & 0xffffU);
  } else {
    word[0] += 0x10000U;
  }
  ++map_.pools_[c.pool()].gone;
}

Cell Transaction::put(const CellDraft& draft, const DraftForm& form) {
  std::vector<std::uint32_t> vertices = form.corners;
  ShapeTable::Interned shape{};
  if (form.pool == CombinatorialMap::general_pool) {
    set_key(draft, form, vertices);
    shape = map_.shapes_.intern(key_);
  } else {
    const CellType type = map_.type_of(form.pool);
    shape =
        map_.shapes_.intern_standard(standard_signature(type, vertices), [&] { return standard_key(type, vertices); });
  }
  added_.push_back({{}, false, shape});
  const std::size_t faces = draft.faces.size();
  const std::size_t words = 2 + vertices.size() + (form.pool == CombinatorialMap::general_pool ? 2 : 1) * faces;
  const Cell c = open_place(form.pool, static_cast<std::uint32_t>(words));
  map_.write_cell(c, shape.number, vertices, draft.free);
  map_.pools_[c.pool()].source[c.index()] = draft.source;
  count_vertices(c, true);
  write_sides(c, draft, form);
  return c;
}

// A vacant place for a record of this length, or a new one.
Cell Transaction::open_place(std::uint32_t pool, std::uint32_t words) {
  CombinatorialMap::Pool& p = map_.pools_[pool];
  const auto vacant = p.vacant.find(words);
  AddedCell& added = added_.back();
  if (vacant != p.vacant.end() && !vacant->second.empty()) {
    added.cell = Cell(pool, vacant->second.back());
    vacant->second.pop_back();
    --p.gone;
    map_.record(added.cell)[1] &= ~CombinatorialMap::vacant_bit;
    return added.cell;
  }
  if (p.count >= Cell::index_mask)
    throw EditRefused("the map would have more than 2^29 - 1 cells of one type: split the scene");
  p.source.push_back(0);
  map_.open_record(pool, words);
  added.cell = Cell(pool, static_cast<std::uint32_t>(p.count++));
  added.appended = true;
  return added.cell;
}

// Patches and flat marks, by the numbers of the record: a face's darts start at its lowest corner.
void Transaction::write_sides(Cell c, const CellDraft& draft, const DraftForm& form) {
  const Shape& s = map_.shape(c);
  for (std::size_t i = 0; i < draft.faces.size(); ++i) {
    const DraftFace& face = draft.faces[i];
    const std::uint16_t f = form.face[i];
    if (face.patch != Patch{}) map_.set_patch({c, f}, face.patch);
    const auto lowest = std::min_element(face.corners.begin(), face.corners.end(),
                                         [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
    const std::size_t k = s.degree(f);
    const std::size_t first = s.dimension() == 2 ? 0 : static_cast<std::size_t>(lowest - face.corners.begin());
    for (std::size_t j = 0; j < k; ++j) {
      const DraftCorner& corner = face.corners[(first + j) % k];
      const auto bits = (corner.straight ? CombinatorialMap::straight_bit : 0) |
                        (corner.coplanar ? CombinatorialMap::coplanar_bit : 0);
      if (bits == 0) continue;
      map_.record(c)[1] |= CombinatorialMap::flat_bit;
      map_.flats_.set(c, static_cast<std::uint16_t>(s.first_dart(f) + j), static_cast<std::uint16_t>(bits));
    }
  }
}

void Transaction::clear_sides(Cell c) {
  const Shape& s = map_.shape(c);
  if (map_.has_patch(c)) {
    for (std::uint16_t f = 0; f < s.face_count(); ++f) map_.patches_.set(c, f, 0);
  }
  if (map_.has_flat(c)) {
    for (std::uint16_t d = 0; d < s.dart_count(); ++d) map_.flats_.set(c, d, 0);
  }
}

void Transaction::link(const Replacement& plan, std::span<const Cell> cells) {
  for (const Replacement::Link& l : plan.links) {
    const CellFace here{cells[l.draft], plan.forms[l.draft].face[l.face]};
    CellFace there = l.outer;
    if (there.valid()) {
      keep_face(there);
    } else {
      there = {cells[l.other], plan.forms[l.other].face[l.other_face]};
    }
    map_.set_neighbour(here, there);
    map_.set_neighbour(there, here);
  }
  for (const Cell c : cells) map_.mark_walls(c);
}

void Transaction::set_free(Cell c, bool free) {
  if (!map_.contains(c)) throw InvalidArgument("there is no such cell to mark: an earlier edit replaced it");
  if (map_.is_free(c) == free) return;
  marked_.push_back(c);
  keep(c, 1);
  for (std::uint16_t f = 0; f < map_.shape(c).face_count(); ++f) {
    keep_face({c, f});
    if (const CellFace other = map_.opposite({c, f}); other.valid()) keep_face(other);
  }
  map_.set_free(c, free);
}

Transaction::Savepoint Transaction::savepoint() const {
  return {words_.size(), added_.size(), removed_.size(), created_.size(), merged_.size(), marked_.size()};
}

void Transaction::roll_back(const Savepoint& to) {
  for (; words_.size() > to.words; words_.pop_back())
    map_.pools_[words_.back().pool].words[words_.back().at] = words_.back().value;
  for (; removed_.size() > to.removed; removed_.pop_back()) {
    count_vertices(removed_.back(), true);
    --map_.pools_[removed_.back().pool()].gone;
  }
  for (; added_.size() > to.added; added_.pop_back()) take_back(added_.back());
  for (; created_.size() > to.created; created_.pop_back()) {
    const Vertex v = created_.back().vertex.vertex;
    if (created_.back().appended) {
      map_.cells_at_.pop_back();
      --map_.vertex_count_;
    } else {
      map_.cells_at_[v.value] = CombinatorialMap::vacant_vertex;
      map_.vacant_vertices_.push_back(v);
    }
  }
  merged_.resize(to.merged);
  marked_.resize(to.marked);
}

void Transaction::take_back(const AddedCell& added) {
  const Cell c = added.cell;
  if (c.valid()) {
    count_vertices(c, false);
    clear_sides(c);
    if (added.appended) {
      drop_last(c.pool(), length_of(c));
    } else {
      vacate(c);
      ++map_.pools_[c.pool()].gone;
    }
  }
  map_.shapes_.undo(added.shape);
}

std::uint32_t Transaction::length_of(Cell c) const {
  const Shape& s = map_.shape(c);
  return 2U + s.point_count() + (c.pool() == CombinatorialMap::general_pool ? 2U : 1U) * s.face_count();
}

void Transaction::drop_last(std::uint32_t pool, std::uint32_t words) {
  CombinatorialMap::Pool& p = map_.pools_[pool];
  p.words.resize(p.words.size() - words);
  if (pool == CombinatorialMap::general_pool) p.offsets.pop_back();
  p.source.pop_back();
  --p.count;
}

// Clears a record except its version, and makes its place vacant. A place whose versions have run out is not used
// again; this happens once in 65,535 cells.
void Transaction::vacate(Cell c) {
  CombinatorialMap::Pool& p = map_.pools_[c.pool()];
  const std::uint32_t words = length_of(c);
  const std::uint16_t version = map_.view(c).version();
  std::uint32_t* word = map_.record(c);
  std::fill_n(word, words, 0U);
  word[c.pool() == CombinatorialMap::general_pool ? 1 : 0] =
      c.pool() == CombinatorialMap::general_pool ? version : std::uint32_t{version} << 16U;
  word[1] |= CombinatorialMap::vacant_bit;
  p.source[c.index()] = Cell::invalid_value;
  if (version != 0xffffU) p.vacant[words].push_back(c.index());
}

EditReport Transaction::commit() {
  EditReport report = report_cells();
  release_vertices(report);
  for (const Cell c : removed_) {
    const CellView v = map_.view(c);
    const std::uint32_t shape = c.pool() == CombinatorialMap::general_pool ? v.words()[0] : v.words()[0] & 0xffffU;
    clear_sides(c);
    vacate(c);
    map_.shapes_.release(shape);
  }
  report.merged = std::move(merged_);
  words_.clear();
  added_.clear();
  removed_.clear();
  created_.clear();
  merged_.clear();
  marked_.clear();
  return report;
}

std::vector<Cell> Transaction::added() const {
  std::vector<Cell> cells;
  for (const AddedCell& a : added_) {
    if (map_.contains(a.cell)) cells.push_back(a.cell);
  }
  return cells;
}

// Cells that were added and removed within the transaction are not reported.
std::vector<Cell> Transaction::removed() const {
  const std::vector<Cell> news = all_added();
  std::vector<Cell> cells;
  for (const Cell c : removed_) {
    if (!std::binary_search(news.begin(), news.end(), c)) cells.push_back(c);
  }
  return cells;
}

std::vector<Cell> Transaction::all_added() const {
  std::vector<Cell> cells;
  for (const AddedCell& a : added_) cells.push_back(a.cell);
  std::sort(cells.begin(), cells.end());
  return cells;
}

std::vector<Cell> Transaction::marked() const {
  const std::vector<Cell> news = all_added();
  std::vector<Cell> cells;
  for (const Cell c : marked_) {
    if (map_.contains(c) && !std::binary_search(news.begin(), news.end(), c)) cells.push_back(c);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

EditReport Transaction::report_cells() const {
  EditReport report;
  for (const Cell c : removed()) report.removed.push_back({c, static_cast<std::uint16_t>(map_.view(c).version() - 1U)});
  report.added = added();
  report.marked = marked();
  return report;
}

// Vertices without cells. Those that the transaction made are dropped without a report.
void Transaction::release_vertices(EditReport& report) {
  const auto give_up = [&](Vertex v) {
    map_.cells_at_[v.value] = CombinatorialMap::vacant_vertex;
    map_.vacant_vertices_.push_back(v);
  };
  for (const Created& b : created_) {
    if (map_.cells_at_[b.vertex.vertex.value] == 0) {
      give_up(b.vertex.vertex);
    } else {
      report.created.push_back(b.vertex);
    }
  }
  for (const Cell c : removed_) {
    for (const std::uint32_t v : map_.view(c).vertices()) {
      if (map_.cells_at_[v] != 0) continue;
      give_up(Vertex(v));
      report.deleted.emplace_back(v);
    }
  }
}

}  // namespace dartcast
