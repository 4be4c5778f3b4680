#include "dartcast/map/draft.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "dartcast/map/cell_form.hpp"
#include "dartcast/mesh/cell_types.hpp"

namespace dartcast {

CellDraft draft_of(const Map& map, Cell c) {
  const CellView v = map.view(c);
  const Shape& s = v.shape();
  CellDraft draft;
  draft.free = v.is_free();
  draft.source = map.source(c);
  draft.faces.resize(s.face_count());
  std::uint16_t point = s.corner_count();
  for (std::uint16_t f = 0; f < s.face_count(); ++f) {
    DraftFace& face = draft.faces[f];
    face.from = {c, f};
    face.across.face = map.opposite({c, f});
    face.patch = map.patch(CellFace{c, f});
    if (s.key().faces[f].has_point) face.point = v.vertex(point++);
    face.corners.reserve(s.degree(f) + std::size_t{1});
    for (std::uint16_t d = s.first_dart(f); d < s.first_dart(static_cast<std::uint16_t>(f + 1)); ++d)
      face.corners.push_back({v.vertex(s.origin(d)), map.may_be_straight({c, d}), map.may_be_coplanar({c, d})});
  }
  return draft;
}

namespace {

constexpr std::size_t most_darts = 0x3fff;

class Judge {
 public:
  explicit Judge(const CellDraft& draft) : draft_(draft) {}

  DraftForm form() {
    DraftForm form;
    form.defect = defect();
    if (!form.defect.empty()) return form;
    form.face.resize(draft_.faces.size());
    if (!has_points() && standard(form)) return form;
    std::iota(form.face.begin(), form.face.end(), std::uint16_t{0});
    corners_by_appearance(form.corners);
    return form;
  }

 private:
  struct Edge {
    std::uint64_t ends;  // origin in the upper half
    std::uint16_t dart;
    bool operator<(const Edge& other) const { return ends < other.ends; }
  };
  static constexpr std::uint16_t none = 0xffffU;

  static std::uint64_t ends(std::uint32_t a, std::uint32_t b) { return (std::uint64_t{a} << 32U) | b; }

  std::string defect() {
    if (draft_.faces.size() < 4) return "would have fewer than four faces";
    if (std::string faces = flatten(); !faces.empty()) return faces;
    for (std::uint16_t d = 0; d < origin_.size(); ++d) edges_.push_back({ends(origin_[d], origin_[next(d)]), d});
    std::sort(edges_.begin(), edges_.end());
    const auto twice =
        std::adjacent_find(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.ends == b.ends; });
    if (twice != edges_.end())
      return "would have two edges between vertices " + std::to_string(twice->ends >> 32U) + " and " +
             std::to_string(twice->ends & 0xffffffffU);
    for (const Edge& e : edges_) {
      if (dart(static_cast<std::uint32_t>(e.ends & 0xffffffffU), static_cast<std::uint32_t>(e.ends >> 32U)) == none)
        return "would not be closed at the edge between vertices " + std::to_string(e.ends >> 32U) + " and " +
               std::to_string(e.ends & 0xffffffffU);
    }
    if (!is_sphere()) return "would not be one solid without holes, joined by faces alone";
    return points_distinct() ? "" : "would have a point of its own that is a corner, or that serves twice";
  }

  // All faces' darts, one face after another.
  std::string flatten() {
    first_.push_back(0);
    std::vector<std::uint32_t> sorted;
    for (const DraftFace& face : draft_.faces) {
      sorted.clear();
      for (const DraftCorner& c : face.corners) sorted.push_back(c.vertex.value);
      if (origin_.size() + sorted.size() > most_darts) return "would have more than 16383 darts";
      face_of_.resize(origin_.size() + sorted.size(), static_cast<std::uint16_t>(first_.size() - 1));
      origin_.insert(origin_.end(), sorted.begin(), sorted.end());
      first_.push_back(static_cast<std::uint16_t>(origin_.size()));
      std::sort(sorted.begin(), sorted.end());
      if (sorted.size() < 3 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
        return "would have a face with fewer than three corners, or with one corner twice";
    }
    return {};
  }

  [[nodiscard]] std::uint16_t next(std::uint16_t d) const {
    const std::uint16_t f = face_of_[d];
    return d + 1 == first_[f + 1U] ? first_[f] : static_cast<std::uint16_t>(d + 1);
  }

  [[nodiscard]] std::uint16_t dart(std::uint32_t from, std::uint32_t to) const {
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), Edge{ends(from, to), 0});
    return found != edges_.end() && found->ends == ends(from, to) ? found->dart : none;
  }
  [[nodiscard]] std::uint16_t phi2(std::uint16_t d) const { return dart(origin_[next(d)], origin_[d]); }

  // Connected, and of Euler characteristic 2: a vertex that two fans of faces share would count once.
  [[nodiscard]] bool is_sphere() const {
    std::size_t corners = 0;
    for (std::size_t i = 0; i < edges_.size(); ++i)
      corners += i == 0 || edges_[i].ends >> 32U != edges_[i - 1].ends >> 32U ? 1 : 0;
    if (corners + draft_.faces.size() != origin_.size() / 2 + 2) return false;
    std::vector<bool> seen(draft_.faces.size());
    std::vector<std::uint16_t> reached = {0};
    seen[0] = true;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (std::uint16_t d = first_[reached[i]]; d < first_[reached[i] + 1U]; ++d) {
        const std::uint16_t f = face_of_[phi2(d)];
        if (!seen[f]) reached.push_back(f);
        seen[f] = true;
      }
    }
    return reached.size() == draft_.faces.size();
  }

  [[nodiscard]] bool has_points() const {
    return draft_.point.valid() ||
           std::any_of(draft_.faces.begin(), draft_.faces.end(), [](const auto& f) { return f.point.valid(); });
  }

  [[nodiscard]] bool points_distinct() const {
    if (!has_points()) return true;
    std::vector<std::uint32_t> points;
    for (const DraftFace& f : draft_.faces) {
      if (f.point.valid()) points.push_back(f.point.value);
    }
    if (draft_.point.valid()) points.push_back(draft_.point.value);
    std::sort(points.begin(), points.end());
    const auto is_corner = [&](std::uint32_t v) {
      const auto found = std::lower_bound(edges_.begin(), edges_.end(), Edge{ends(v, 0), 0});
      return found != edges_.end() && found->ends >> 32U == v;
    };
    return std::adjacent_find(points.begin(), points.end()) == points.end() &&
           std::none_of(points.begin(), points.end(), is_corner);
  }

  // Vertices in the order in which the faces name them first.
  void corners_by_appearance(std::vector<std::uint32_t>& corners) const {
    std::vector<Edge> first;  // vertex, dart
    for (std::uint16_t d = 0; d < origin_.size(); ++d) first.push_back({ends(origin_[d], d), d});
    std::sort(first.begin(), first.end());
    const auto last = std::unique(first.begin(), first.end(),
                                  [](const Edge& a, const Edge& b) { return a.ends >> 32U == b.ends >> 32U; });
    first.erase(last, first.end());
    std::sort(first.begin(), first.end(), [](const Edge& a, const Edge& b) { return a.dart < b.dart; });
    for (const Edge& e : first) corners.push_back(origin_[e.dart]);
  }

  // The type with these numbers of faces and corners, if the faces are its faces.
  bool standard(DraftForm& form) const {
    const std::size_t faces = draft_.faces.size();
    const std::size_t darts = origin_.size();
    if (faces == 4 && darts == 12) return standard(form, CellType::tetrahedron, 3);
    if (faces == 6 && darts == 24) return standard(form, CellType::hexahedron, 4);
    if (faces == 5 && darts == 18) return standard(form, CellType::prism, 3);
    if (faces == 5 && darts == 16) return standard(form, CellType::pyramid, 4);
    return false;
  }

  bool standard(DraftForm& form, CellType type, std::size_t base_degree) const {
    const auto base = std::find_if(draft_.faces.begin(), draft_.faces.end(),
                                   [&](const DraftFace& f) { return f.corners.size() == base_degree; });
    if (base == draft_.faces.end()) return false;
    const std::uint16_t first = first_[static_cast<std::size_t>(base - draft_.faces.begin())];
    std::array<std::uint32_t, 8> corners{};
    const std::size_t count = corner_count(type);
    // The base is seen from the inside in the type's order; above each of its corners is the end of the third edge.
    for (std::size_t i = 0; i < base_degree; ++i) {
      const auto d = static_cast<std::uint16_t>(first + i);
      const std::size_t place = (base_degree - i) % base_degree;
      const std::uint16_t above = next(next(phi2(d)));
      corners[place] = origin_[d];
      const bool apex = type == CellType::tetrahedron || type == CellType::pyramid;
      corners[apex ? base_degree : place + base_degree] = origin_[above];
    }
    const StandardCorners best = turned(type, std::span<const std::uint32_t>(corners.data(), count));
    if (!faces_match(form, type, best)) return false;
    form.pool = static_cast<std::uint32_t>(type);
    form.corners.assign(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(count));
    return true;
  }

  // Whether the draft has every face of the type, each once; numbers them.
  bool faces_match(DraftForm& form, CellType type, const StandardCorners& corners) const {
    std::uint16_t number = 0;
    unsigned matched = 0;
    for (const auto& face : standard_faces(type)) {
      std::uint16_t d = dart(corners[face[0]], corners[face[1]]);
      if (d == none || draft_.faces[face_of_[d]].corners.size() != face.size()) return false;
      if ((matched >> face_of_[d] & 1U) != 0) return false;
      matched |= 1U << face_of_[d];
      form.face[face_of_[d]] = number++;
      for (const std::uint8_t k : face) {
        if (origin_[d] != corners[k]) return false;
        d = next(d);
      }
    }
    return true;
  }

  const CellDraft& draft_;
  std::vector<std::uint32_t> origin_;  // by dart
  std::vector<std::uint16_t> face_of_;
  std::vector<std::uint16_t> first_;  // dart of each face
  std::vector<Edge> edges_;           // sorted
};

}  // namespace

DraftForm form_of(const CellDraft& draft) { return Judge(draft).form(); }

}  // namespace dartcast
