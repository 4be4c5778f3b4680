// Evaluates sampled arrays at all particles.
#include "simulation/sampled_fields.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/predicates.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

std::size_t SampledFields::column(const std::string& name) const {
  return static_cast<std::size_t>(std::find(data_names_.begin(), data_names_.end(), name) - data_names_.begin());
}

SampledFields::Component SampledFields::component(const std::string& name) const {
  for (const SampledField& f : fields_) {
    const auto found = std::find(f.names.begin(), f.names.end(), name);
    if (found != f.names.end()) return {&f.field, static_cast<std::size_t>(found - f.names.begin())};
  }
  return {};
}

// Linear in the particle's simplex. A sliver has no gradient.
SampledFields::Value SampledFields::at(const Component& of, const ParticleState& state, bool moving) const {
  const CellComplex& complex = environment_.complex();
  const Corners now = complex.corners(state.at());
  const Weights at = detail::barycentric(moving ? complex.previous_corners(state.at()) : now, state.position);
  const unsigned corners = complex.map().dimension() + 1;
  std::array<double, 4> values{};
  double value = 0.0;
  for (unsigned k = 0; k < corners; ++k) {
    Weights corner{};
    corner[k] = 1.0;
    const Vec3 v = of.field->at(complex, state.at(), corner, now);
    values[k] = of.number == 0 ? v.x : of.number == 1 ? v.y : v.z;
    value += at[k] * values[k];
  }
  // In the plane the corners have a fourth one above it, which must not tilt the gradient.
  const std::array<Vec3, 3> edges = {now[1] - now[0], now[2] - now[0],
                                     corners == 4 ? now[3] - now[0] : Vec3{0.0, 0.0, 1.0}};
  const std::array<Vec3, 3> duals = detail::duals(edges);
  const double volume = dot(edges[0], duals[0]);
  Vec3 gradient;
  for (unsigned k = 1; k < corners; ++k) gradient += duals[k - 1] * ((values[k] - values[0]) / volume);
  return {std::max(value, 0.0), is_finite(gradient) ? gradient : Vec3{}};
}

void SampledFields::take(ParticleSet& set, double time, double duration) {
  constexpr std::size_t grain = 512;
  const CellComplex& complex = environment_.complex();
  for (SampledField& f : fields_) {
    f.field.set_times(std::span(&time, 1), complex, environment_.threads());
    const std::size_t values = column(f.names.front());
    std::vector<std::size_t> sums;
    for (const SampledField::Integral& sum : f.integrals) sums.push_back(column(sum.name));
    parallel_for(set.states.size(), grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const ParticleState& s = set.states[i];
        const std::span<double> data = set.user_data(i);
        const std::span<double> now = data.subspan(values, f.names.size());
        std::array<double, 3> before{};
        std::copy(now.begin(), now.end(), before.begin());
        if (!s.held) {
          const Corners corners = complex.corners(s.at());
          const Vec3 v = f.field.at(complex, s.at(), detail::barycentric(corners, s.position), corners);
          const std::array<double, 3> found = {v.x, v.y, v.z};
          std::copy_n(found.begin(), now.size(), now.begin());
        }
        for (std::size_t k = 0; k < sums.size(); ++k) {
          const std::size_t component = f.integrals[k].component;
          data[sums[k]] += 0.5 * duration * (before[component] + now[component]);
        }
      }
    });
  }
}

}  // namespace dartcast
