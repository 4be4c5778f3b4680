// Where a prescribed motion puts the vertices, and which motions are allowed.
#include "dartcast/deformation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "simulation/deformation_frames.hpp"
#include "simulation/motion.hpp"

namespace dartcast {
namespace {

constexpr std::size_t vertex_grain = 2048;  // vertices: their positions stay in the fastest cache for all motions

bool is_off_plane(const Vec3& v) { return v.z != 0.0; }

class DeformationChecker {
 public:
  DeformationChecker(const DeformationStep& step, std::size_t index, std::size_t vertices)
      : step_(step), index_(index), vertices_(vertices) {}

  void check() const {
    const DeformationStep& s = step_;
    require(std::isfinite(s.amplitude), "amplitude must be finite");
    require(s.period > 0 && std::isfinite(s.period), "period must be positive");
    require(is_finite(s.axis) && is_finite(s.centre) && is_finite(s.direction),
            "axis, centre and direction must be finite");
    require(s.wavelength >= 0 && std::isfinite(s.wavelength), "wavelength must be 0 or positive");
    require(s.field.empty() || s.field.size() == vertices_, "field must have one entry per vertex");
    require(s.path.empty() || s.path.size() == vertices_, "path must have one entry per vertex");
    require(std::all_of(s.field.begin(), s.field.end(), is_finite), "field must be finite");
    require(std::all_of(s.path.begin(), s.path.end(), [](double p) { return std::isfinite(p); }),
            "path must be finite");
    check_kind();
  }

 private:
  void check_kind() const {
    switch (step_.kind) {
      case DeformationKind::rotate:
      case DeformationKind::swing: return check_axis();
      case DeformationKind::bend:
        check_length();
        check_axis();
        return require(norm(cross(step_.axis, step_.direction)) > 1e-6 * norm(step_.axis) * norm(step_.direction),
                       "direction must not be 0 or along the axis");
      case DeformationKind::twist:
      case DeformationKind::bump: check_length(); return check_axis();
      case DeformationKind::stretch:
        require(std::abs(step_.amplitude) < 1, "amplitude must be between -1 and 1");
        return check_axis();
      case DeformationKind::pulse: return;
      case DeformationKind::frames:
        return require(index_ == 0, "frames must come first in the list: they give positions, not changes");
    }
  }

  void check_axis() const { require(norm(step_.axis) > 0, "axis must not be 0"); }
  void check_length() const { require(step_.length > 0 && std::isfinite(step_.length), "length must be positive"); }

  void require(bool holds, std::string_view text) const {
    if (holds) return;
    throw InvalidArgument(fmt::format("deformation {} ({}): {}", index_ + 1, name_of(step_.kind), text));
  }

  const DeformationStep& step_;
  std::size_t index_, vertices_;
};

// Checks the members of a step: it must keep each point of the plane z = 0 in the plane, to the last bit.
class PlaneChecker {
 public:
  PlaneChecker(const DeformationStep& step, std::size_t index) : step_(step), index_(index) {}

  void check() const {
    require(step_.centre.z == 0.0, "centre", "must have z = 0");
    switch (step_.kind) {
      case DeformationKind::rotate:
      case DeformationKind::swing: return require(across(), "axis", "must be [0, 0, 1]");
      case DeformationKind::twist: return require(across(), "axis", "must be [0, 0, 1]; to move points, swing or bend");
      case DeformationKind::bend:
        require(along() || across(), "axis", "must have z = 0");
        return require(step_.direction.z == 0.0, "direction", "must have z = 0");
      case DeformationKind::stretch: return require(along() || across(), "axis", "must have z = 0 or be [0, 0, 1]");
      case DeformationKind::bump: return require(along(), "axis", "must have z = 0");
      case DeformationKind::pulse: return check_pulse();
      case DeformationKind::frames: return;
    }
  }

 private:
  [[nodiscard]] bool along() const { return step_.axis.z == 0.0; }
  [[nodiscard]] bool across() const { return step_.axis.x == 0.0 && step_.axis.y == 0.0; }

  void check_pulse() const {
    if (step_.field.empty()) return require(along() || across(), "axis", "must have z = 0 or be [0, 0, 1]");
    check_list(step_.field, "field", "vector");
  }

  void check_list(std::span<const Vec3> list, const std::string& name, const char* what) const {
    const auto out = std::find_if(list.begin(), list.end(), is_off_plane);
    if (out == list.end()) return;
    require(false, name,
            fmt::format("must have z = 0 everywhere, and its {} {} has z = {}", what, out - list.begin(), out->z));
  }

  void require(bool holds, const std::string& member, const std::string& must) const {
    if (holds) return;
    throw InvalidArgument(fmt::format(
        "deformation {} ({}) moves points out of the plane z = 0, which a planar mesh must not leave: {} {}",
        index_ + 1, name_of(step_.kind), member, must));
  }

  const DeformationStep& step_;
  std::size_t index_;
};

}  // namespace

std::string_view name_of(DeformationKind kind) {
  switch (kind) {
    case DeformationKind::rotate: return "rotate";
    case DeformationKind::swing: return "swing";
    case DeformationKind::bend: return "bend";
    case DeformationKind::twist: return "twist";
    case DeformationKind::stretch: return "stretch";
    case DeformationKind::pulse: return "pulse";
    case DeformationKind::bump: return "bump";
    case DeformationKind::frames: return "frames";
  }
  return {};
}

std::optional<DeformationKind> deformation_kind(std::string_view name) {
  for (const DeformationKind kind : deformation_kinds) {
    if (name_of(kind) == name) return kind;
  }
  return std::nullopt;
}

Deformation::Deformation(std::vector<DeformationStep> steps, std::span<const Vec3> rest)
    : steps_(std::move(steps)), rest_(rest.begin(), rest.end()), size_(rest.size()) {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    DeformationStep& s = steps_[i];
    DeformationChecker(s, i, rest_.size()).check();
    if (norm(s.axis) > 0) s.axis *= 1 / norm(s.axis);
    s.direction -= s.axis * dot(s.axis, s.direction);
    if (s.kind == DeformationKind::bend) s.direction *= 1 / norm(s.direction);
  }
  if (steps_.empty() || steps_.front().kind != DeformationKind::frames) return;
  frames_ = std::make_shared<DeformationFrames>(std::move(steps_.front()), rest_.size());
  steps_.erase(steps_.begin());
}

void Deformation::check_plane() {
  if (frames_) frames_->check_plane();
  for (std::size_t i = 0; i < steps_.size(); ++i) PlaneChecker(steps_[i], i + (frames_ ? 1 : 0)).check();
  for (const Later& later : later_) {
    const auto* pull = std::get_if<Pull>(&later);
    if (pull != nullptr && std::any_of(pull->displacement.begin(), pull->displacement.end(), is_off_plane))
      throw InvalidArgument(
          "deformation: a pull moves points out of the plane z = 0, which a planar mesh must not leave");
  }
  in_plane_ = true;
}

void Deformation::load_frames(double time) const {
  if (!std::isfinite(time)) throw InvalidArgument("deformation: time must be finite");
  if (frames_) frames_->at(time, in_plane_);
}

void Deformation::positions(double time, std::span<Vec3> out, Threads threads) const {
  if (!std::isfinite(time)) throw InvalidArgument("deformation: time must be finite");
  if (out.size() != size_) {
    throw InvalidArgument(
        fmt::format("deformation: room for {} positions is given; the mesh has {} vertices", out.size(), size_));
  }
  std::vector<detail::Motion> motions;
  motions.reserve(steps_.size());
  for (const DeformationStep& s : steps_) motions.emplace_back(s, time);
  const FrameBlend start = frames_ ? frames_->at(time, in_plane_) : FrameBlend{{rest_}, {}, {}};
  parallel_for(rest_.size(), vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
    start.copy(begin, end, out);
    for (const detail::Motion& motion : motions) detail::apply(motion, out.subspan(begin, end - begin), begin);
  });
  add_later(time, out);
}

void Deformation::at_rest(std::span<Vec3> out) const {
  std::copy(rest_.begin(), rest_.end(), out.begin());
  add_later(0.0, out);
}

void Deformation::update_after_edit(const ComplexEditReport& edit, std::size_t size) {
  later_.insert(later_.end(), edit.placed.begin(), edit.placed.end());
  size_ = size;
}

void Deformation::add_pull(std::span<const Vec3> displacement, double begin, double end) {
  if (displacement.size() != size_)
    throw InvalidArgument(fmt::format("deformation: {} displacements for {} vertices", displacement.size(), size_));
  if (!std::isfinite(begin) || !std::isfinite(end) || !(end > begin))
    throw InvalidArgument("deformation: a pull must end after it starts");
  if (!std::all_of(displacement.begin(), displacement.end(), is_finite))
    throw InvalidArgument("deformation: a displacement is not finite");
  Pull pull{{}, {}, begin, end};
  for (std::size_t v = 0; v < displacement.size(); ++v) {
    if (displacement[v] == Vec3{}) continue;
    pull.vertex.push_back(static_cast<std::uint32_t>(v));
    pull.displacement.push_back(displacement[v]);
  }
  later_.emplace_back(std::move(pull));
}

// A vertex that was made after a pull goes with the pulled ones.
void Deformation::add_later(double time, std::span<Vec3> out) const {
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  for (const Later& later : later_) {
    if (const auto* pull = std::get_if<Pull>(&later)) {
      const double share = smooth(std::clamp((time - pull->begin) / (pull->end - pull->begin), 0.0, 1.0));
      for (std::size_t i = 0; i < pull->vertex.size(); ++i) out[pull->vertex[i]] += pull->displacement[i] * share;
      continue;
    }
    const auto& placed = std::get<PlacedVertex>(later);
    if (placed.vertex.value >= out.size()) continue;
    Vec3 x = placed.offset;
    for (std::size_t i = 0; i < placed.of.size(); ++i) x += out[placed.of[i].value] * placed.weights[i];
    out[placed.vertex.value] = x;
  }
}

std::vector<Vec3> pull_around(std::span<const Vec3> positions, const Vec3& at, const Vec3& by, double reach) {
  if (!is_finite(at) || !is_finite(by) || !(reach > 0.0) || !std::isfinite(reach))
    throw InvalidArgument("deformation: the place and the way of a pull must be finite, and its reach positive");
  std::vector<Vec3> pull(positions.size());
  for (std::size_t i = 0; i < pull.size(); ++i) {
    const Vec3 d = positions[i] - at;
    const double share = dot(d, d) / (reach * reach);
    if (share < 1.0) pull[i] = by * ((1.0 - share) * (1.0 - share));
  }
  return pull;
}

}  // namespace dartcast
