// Checks drafts of cells, and finds the form in which each goes into a record.
#include <algorithm>
#include <array>
#include <numeric>

#include "dartcast/map_edits.hpp"
#include "mesh/cell_types.hpp"
#include "topology/cell_form.hpp"
#include "topology/key_table.hpp"

namespace dartcast {

CellDraft draft_of(const CombinatorialMap& map, Cell c) {
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
    for (std::uint16_t d = s.first_dart(f); d < s.first_dart(static_cast<std::uint16_t>(f + 1)); ++d) {
      const CombinatorialMap::Flat flat = map.flat({c, d});
      face.corners.push_back({v.vertex(s.origin(d)), flat.straight, flat.coplanar});
    }
    if (s.dimension() == 2) face.corners.push_back({v.vertex(s.corners(f)[1])});
  }
  return draft;
}

namespace {

class DraftChecker {
 public:
  DraftForm form(const CellDraft& draft) {
    reset(draft);
    DraftForm form;
    form.defect = defect();
    if (!form.defect.empty()) return form;
    form.face.resize(draft_->faces.size());
    if (!has_points() && standard(form)) return form;
    std::iota(form.face.begin(), form.face.end(), std::uint16_t{0});
    form.pool = CombinatorialMap::general_pool;
    form.corners = corners_;
    form.local = origin_;
    return form;
  }

 private:
  static constexpr std::uint32_t none = detail::KeyTable::none;

  void reset(const CellDraft& draft) {
    draft_ = &draft;
    std::size_t darts = 0;
    for (const DraftFace& face : draft.faces) darts += face.corners.size();
    local_.reset(std::min(darts, Shape::max_darts) / 3);  // each corner has three faces or more, mostly
    edges_.reset(std::min(darts, Shape::max_darts));
    corners_.clear();
    origin_.clear();
    face_of_.clear();
    phi2_.clear();
    first_.clear();
  }

  std::string defect() {
    if (draft_->faces.size() < 4) return "would have fewer than four faces";
    if (std::string faces = flatten(); !faces.empty()) return faces;
    if (std::string edges = pair_edges(); !edges.empty()) return edges;
    if (!is_sphere()) return "would not be one solid without holes, joined by faces alone";
    return points_distinct() ? "" : "would have a Steiner point that is a corner, or that is used twice";
  }

  // All faces' darts, one face after another; corners are numbered as they appear.
  std::string flatten() {
    first_.reserve(draft_->faces.size() + 1);
    first_.push_back(0);
    std::vector<std::uint16_t> last;  // last face that had the corner
    for (const DraftFace& face : draft_->faces) {
      if (origin_.size() + face.corners.size() > Shape::max_darts) return "would have more than 16383 darts";
      const auto f = static_cast<std::uint16_t>(first_.size());
      bool distinct = face.corners.size() >= 3;
      for (const DraftCorner& c : face.corners) {
        std::uint32_t& local = local_[c.vertex.value];
        if (local == none) {
          local = static_cast<std::uint32_t>(corners_.size());
          corners_.push_back(c.vertex.value);
          last.push_back(0);
        }
        distinct = distinct && last[local] != f;
        last[local] = f;
        origin_.push_back(static_cast<std::uint16_t>(local));
        face_of_.push_back(static_cast<std::uint16_t>(f - 1U));
      }
      if (!distinct) return "would have a face with fewer than three corners, or with one corner twice";
      first_.push_back(static_cast<std::uint16_t>(origin_.size()));
    }
    return {};
  }

  std::string pair_edges() {
    const auto between = [&](std::uint16_t d) {
      return " between vertices " + std::to_string(corners_[origin_[d]]) + " and " +
             std::to_string(corners_[origin_[next(d)]]);
    };
    for (std::uint16_t d = 0; d < origin_.size(); ++d) {
      std::uint32_t& dart = edges_[ends(origin_[d], origin_[next(d)])];
      if (dart != none) return "would have two edges" + between(d);
      dart = d;
    }
    phi2_.resize(origin_.size());
    for (std::uint16_t d = 0; d < origin_.size(); ++d) {
      const std::uint32_t other = edges_.find(ends(origin_[next(d)], origin_[d]));
      if (other == none) return "would not be closed at the edge" + between(d);
      phi2_[d] = static_cast<std::uint16_t>(other);
    }
    return {};
  }

  static std::uint64_t ends(std::uint32_t a, std::uint32_t b) { return (std::uint64_t{a} << 32U) | b; }

  [[nodiscard]] std::uint16_t next(std::uint16_t d) const {
    const std::uint16_t f = face_of_[d];
    return d + 1 == first_[f + 1U] ? first_[f] : static_cast<std::uint16_t>(d + 1);
  }

  // The surface must be connected and have Euler characteristic 2. A vertex that two fans of faces share counts once.
  [[nodiscard]] bool is_sphere() const {
    if (corners_.size() + draft_->faces.size() != origin_.size() / 2 + 2) return false;
    std::vector<bool> seen(draft_->faces.size());
    std::vector<std::uint16_t> reached = {0};
    reached.reserve(draft_->faces.size());
    seen[0] = true;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (std::uint16_t d = first_[reached[i]]; d < first_[reached[i] + 1U]; ++d) {
        const std::uint16_t f = face_of_[phi2_[d]];
        if (!seen[f]) reached.push_back(f);
        seen[f] = true;
      }
    }
    return reached.size() == draft_->faces.size();
  }

  [[nodiscard]] bool has_points() const {
    return draft_->point.valid() ||
           std::any_of(draft_->faces.begin(), draft_->faces.end(), [](const auto& f) { return f.point.valid(); });
  }

  [[nodiscard]] bool points_distinct() const {
    if (!has_points()) return true;
    std::vector<std::uint32_t> points;
    for (const DraftFace& f : draft_->faces) {
      if (f.point.valid()) points.push_back(f.point.value);
    }
    if (draft_->point.valid()) points.push_back(draft_->point.value);
    std::sort(points.begin(), points.end());
    return std::adjacent_find(points.begin(), points.end()) == points.end() &&
           std::none_of(points.begin(), points.end(), [&](std::uint32_t v) { return local_.find(v) != none; });
  }

  // The type with these numbers of faces and corners, if the faces match.
  bool standard(DraftForm& form) const {
    const std::size_t faces = draft_->faces.size();
    const std::size_t darts = origin_.size();
    if (faces == 4 && darts == 12) return standard(form, CellType::tetrahedron, 3);
    if (faces == 6 && darts == 24) return standard(form, CellType::hexahedron, 4);
    if (faces == 5 && darts == 18) return standard(form, CellType::prism, 3);
    if (faces == 5 && darts == 16) return standard(form, CellType::pyramid, 4);
    return false;
  }

  bool standard(DraftForm& form, CellType type, std::size_t base_degree) const {
    const auto base = std::find_if(draft_->faces.begin(), draft_->faces.end(),
                                   [&](const DraftFace& f) { return f.corners.size() == base_degree; });
    if (base == draft_->faces.end()) return false;
    const std::uint16_t first = first_[static_cast<std::size_t>(base - draft_->faces.begin())];
    std::array<std::uint32_t, 8> corners{};
    const std::size_t count = corner_count(type);
    // In the type's order the base is seen from the inside. Above each of its corners is the end of the third edge.
    for (std::size_t i = 0; i < base_degree; ++i) {
      const auto d = static_cast<std::uint16_t>(first + i);
      const std::size_t place = (base_degree - i) % base_degree;
      const std::uint16_t above = next(next(phi2_[d]));
      corners[place] = corners_[origin_[d]];
      const bool apex = type == CellType::tetrahedron || type == CellType::pyramid;
      corners[apex ? base_degree : place + base_degree] = corners_[origin_[above]];
    }
    const StandardCorners best = turned(type, std::span<const std::uint32_t>(corners.data(), count));
    if (!faces_match(form, type, best)) return false;
    form.pool = static_cast<std::uint32_t>(type);
    form.corners.assign(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(count));
    return true;
  }

  // Whether the draft has every face of the type, each once. Numbers them.
  bool faces_match(DraftForm& form, CellType type, const StandardCorners& corners) const {
    std::uint16_t number = 0;
    unsigned matched = 0;
    for (const auto& face : standard_faces(type)) {
      std::uint32_t dart = edges_.find(ends(local_.find(corners[face[0]]), local_.find(corners[face[1]])));
      if (dart == none) return false;
      auto d = static_cast<std::uint16_t>(dart);
      if (draft_->faces[face_of_[d]].corners.size() != face.size() || (matched >> face_of_[d] & 1U) != 0) return false;
      matched |= 1U << face_of_[d];
      form.face[face_of_[d]] = number++;
      for (const std::uint8_t k : face) {
        if (corners_[origin_[d]] != corners[k]) return false;
        d = next(d);
      }
    }
    return true;
  }

  const CellDraft* draft_ = nullptr;
  detail::KeyTable local_;              // number of a vertex among the corners
  detail::KeyTable edges_;              // dart by its ends
  std::vector<std::uint32_t> corners_;  // vertices as they appear
  std::vector<std::uint16_t> origin_;   // by dart, among the corners
  std::vector<std::uint16_t> face_of_;
  std::vector<std::uint16_t> phi2_;
  std::vector<std::uint16_t> first_;  // dart of each face
};

std::string polygon_defect(const CellDraft& draft) {
  if (draft.faces.size() < 3) return "would have fewer than three edges";
  if (draft.faces.size() > Shape::max_darts) return "would have more than 16383 darts";
  std::vector<std::uint32_t> vertices;
  for (std::size_t f = 0; f < draft.faces.size(); ++f) {
    const auto& edge = draft.faces[f].corners;
    const auto& next = draft.faces[(f + 1) % draft.faces.size()].corners;
    if (edge.size() != 2 || next.empty() || edge[1].vertex != next[0].vertex)
      return "would have edges that are not one cycle";
    if (draft.faces[f].point.valid()) return "would have an edge with a Steiner point";
    vertices.push_back(edge[0].vertex.value);
  }
  if (draft.point.valid()) vertices.push_back(draft.point.value);
  std::sort(vertices.begin(), vertices.end());
  return std::adjacent_find(vertices.begin(), vertices.end()) == vertices.end() ? "" : "would have one corner twice";
}

DraftForm form_of_polygon(const CellDraft& draft) {
  DraftForm form;
  form.defect = polygon_defect(draft);
  if (!form.defect.empty()) return form;
  const std::size_t n = draft.faces.size();
  const bool standard = n <= 4 && !draft.point.valid();
  const CellType type = n == 3 ? CellType::triangle : n == 4 ? CellType::quadrilateral : CellType::polygon;
  form.pool = standard ? CombinatorialMap::pool_of(type) : CombinatorialMap::general_pool;
  for (const DraftFace& edge : draft.faces) form.corners.push_back(edge.corners[0].vertex.value);
  std::size_t first = 0;  // the first corner of the record
  if (standard) {
    const StandardCorners best = turned(type, form.corners);
    first =
        static_cast<std::size_t>(std::find(form.corners.begin(), form.corners.end(), best[0]) - form.corners.begin());
    std::rotate(form.corners.begin(), form.corners.begin() + static_cast<std::ptrdiff_t>(first), form.corners.end());
  }
  for (std::size_t f = 0; f < n; ++f) {
    form.face.push_back(static_cast<std::uint16_t>((f + n - first) % n));
    form.local.push_back(static_cast<std::uint16_t>(f));
    form.local.push_back(static_cast<std::uint16_t>((f + 1) % n));
  }
  return form;
}

}  // namespace

DraftForm form_of(const CellDraft& draft, unsigned dimension) {
  return dimension == 2 ? form_of_polygon(draft) : DraftChecker().form(draft);
}

std::vector<DraftForm> forms_of(std::span<const CellDraft> drafts, unsigned dimension) {
  DraftChecker checker;
  std::vector<DraftForm> forms;
  forms.reserve(drafts.size());
  for (const CellDraft& draft : drafts) forms.push_back(dimension == 2 ? form_of_polygon(draft) : checker.form(draft));
  return forms;
}

}  // namespace dartcast
