// Splits cells by planes: numbers the parts, and finds those that a plane crosses.
#include "editing/cutter.hpp"

#include <algorithm>

#include "dartcast/error.hpp"
#include "editing/plane_cut.hpp"

namespace dartcast::detail {

Cutter::Cutter(ComplexEdit& edit, std::span<const Cell> cells) : edit_(edit), work_(edit.topology()) {
  expect_space(edit.map(), "cuts");
  KeyTable named(cells.size());
  pieces_.reserve(cells.size());
  for (const Cell c : cells) {
    if (!edit.map().contains(c))
      throw InvalidArgument("there is no such cell: an earlier edit replaced it; look for cells anew");
    if (named.find(c.value) != KeyTable::none)
      throw InvalidArgument("cell " + std::to_string(edit.map().source(c)) + " is named twice");
    named[c.value] = size();
    pieces_.push_back({c});
  }
}

// A whole cell has a draft, too, if a cell beside it was split.
void Cutter::find_draft(std::uint32_t number) {
  Piece& piece = pieces_[number];
  if (piece.draft == DraftLink::no_draft && work_.taken(piece.cell)) piece.draft = work_.take(piece.cell);
}

std::span<const std::uint32_t> Cutter::corners(std::uint32_t number) {
  find_draft(number);
  const Piece& piece = pieces_[number];
  if (piece.draft == DraftLink::no_draft) {
    const CellView v = edit_.map().view(piece.cell);
    return v.vertices().first(v.shape().corner_count());
  }
  corners_.clear();
  for (const DraftFace& face : work_.draft(piece.draft).faces) {
    for (const DraftCorner& c : face.corners) corners_.push_back(c.vertex.value);
  }
  std::sort(corners_.begin(), corners_.end());
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  return corners_;
}

Vec3 Cutter::middle(std::uint32_t number) {
  Vec3 sum;
  const std::span<const std::uint32_t> all = corners(number);
  for (const std::uint32_t v : all) sum += edit_.position(Vertex(v));
  return sum * (1.0 / static_cast<double>(all.size()));
}

// Calls with the two ends of each edge, from both of its faces.
template <class Visit>
void Cutter::for_each_edge(std::uint32_t number, Visit&& visit) {
  find_draft(number);
  const Piece& piece = pieces_[number];
  if (piece.draft == DraftLink::no_draft) {
    const CellView v = edit_.map().view(piece.cell);
    const Shape& s = v.shape();
    for (std::uint16_t d = 0; d < s.dart_count(); ++d) visit(v.vertex(s.origin(d)), v.vertex(s.origin(s.phi1(d))));
    return;
  }
  for (const DraftFace& face : work_.draft(piece.draft).faces) {
    Vertex from = face.corners.back().vertex;
    for (const DraftCorner& c : face.corners) visit(std::exchange(from, c.vertex), c.vertex);
  }
}

double Cutter::snap_distance(std::span<const std::uint32_t> numbers, const SectionOptions& options) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const std::uint32_t n : numbers) {
    for_each_edge(n, [&](Vertex from, Vertex to) {
      sum += norm(edit_.position(to) - edit_.position(from));
      ++count;
    });
  }
  return options.snap * std::min(sum / static_cast<double>(std::max<std::size_t>(count, 1)), options.finest);
}

void Cutter::take(std::span<const Plane> planes, double within) {
  planes_.emplace(edit_, planes, within);
  sides_of_.clear();
  for (Piece& piece : pieces_) piece.sides = KeyTable::none;
}

const Side* Cutter::sides(std::uint32_t number) {
  Piece& piece = pieces_[number];
  const std::size_t count = planes_->plane_count();
  if (piece.sides == KeyTable::none) {
    piece.sides = static_cast<std::uint32_t>(sides_of_.size() / count);
    sides_of_.resize(sides_of_.size() + count);
    const auto add = [&](Vertex v) {
      const Side* of = planes_->of(v);
      Side* all = &sides_of_[piece.sides * count];
      for (std::size_t k = 0; k < count; ++k) all[k] |= of[k];
    };
    for (const std::uint32_t v : corners(number)) add(Vertex(v));
  }
  return &sides_of_[piece.sides * count];
}

bool Cutter::is_above(std::uint32_t number, std::size_t plane) {
  const Side side = sides(number)[plane];
  return side == 0 || side == both_bits ? planes_->plane(plane).height(middle(number)) > 0.0 : side == above_bit;
}

bool Cutter::reaches_below(std::uint32_t number, std::size_t first_plane) {
  const Side* of = sides(number);
  Side common = below_bit;
  for (std::size_t k = first_plane; k < planes_->plane_count(); ++k) common &= of[k];
  if (common != 0) return true;
  for (std::size_t k = first_plane; k < planes_->plane_count(); ++k) {
    if ((of[k] & below_bit) == 0 && is_above(number, k)) return false;
  }
  return true;
}

Cutter::Parts Cutter::split(std::span<const std::uint32_t> numbers, std::size_t plane) {
  Parts parts;
  std::vector<std::uint32_t> crossed;
  std::vector<std::uint32_t> drafts;
  const auto put = [&](std::uint32_t n) { (is_above(n, plane) ? parts.above : parts.below).push_back(n); };
  for (const std::uint32_t n : numbers) {
    if (sides(n)[plane] != both_bits) {
      put(n);
      continue;
    }
    crossed.push_back(n);
    if (pieces_[n].draft == DraftLink::no_draft) pieces_[n].draft = work_.take(pieces_[n].cell);
    drafts.push_back(pieces_[n].draft);
  }
  const std::vector<std::uint32_t> above = PlaneCut(edit_, work_, *planes_, plane).split(drafts);
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    pieces_[crossed[i]].sides = KeyTable::none;
    if (above[i] == DraftLink::no_draft) {
      parts.whole.push_back(crossed[i]);
      put(crossed[i]);
    } else {
      parts.below.push_back(crossed[i]);
      parts.above.push_back(size());
      pieces_.push_back({pieces_[crossed[i]].cell, above[i]});
    }
  }
  return parts;
}

Succession Cutter::put() {
  for (std::uint32_t n = 0; n < size(); ++n) find_draft(n);
  const std::vector<Cell> now = work_.put();
  for (Piece& piece : pieces_) {
    if (piece.draft != DraftLink::no_draft) piece.cell = now[piece.draft];
  }
  Succession succession;
  succession.pairs.reserve(now.size());
  for (std::uint32_t i = 0; i < now.size(); ++i) succession.pairs.emplace_back(work_.whole(i), now[i]);
  return succession;
}

std::vector<Cell> Cutter::cells(std::span<const std::uint32_t> numbers) const {
  std::vector<Cell> cells;
  cells.reserve(numbers.size());
  for (const std::uint32_t n : numbers) cells.push_back(pieces_[n].cell);
  return cells;
}

}  // namespace dartcast::detail
