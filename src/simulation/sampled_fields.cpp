// Evaluates sampled arrays at all particles.
#include "simulation/sampled_fields.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"

namespace dartcast {

void SampledFields::take(ParticleSet& set, double time) {
  constexpr std::size_t grain = 512;
  const CellComplex& complex = environment_.complex();
  for (SampledField& f : fields_) {
    f.field.set_times(std::span(&time, 1), complex, environment_.threads());
    const auto column = static_cast<std::size_t>(std::find(data_names_.begin(), data_names_.end(), f.names.front()) -
                                                 data_names_.begin());
    parallel_for(set.states.size(), grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const ParticleState& s = set.states[i];
        if (s.held) continue;
        const Corners now = complex.corners(s.at());
        const Vec3 v = f.field.at(complex, s.at(), detail::barycentric(now, s.position), now);
        const std::array<double, 3> values = {v.x, v.y, v.z};
        std::copy_n(values.begin(), f.names.size(), set.user_data(i).begin() + static_cast<std::ptrdiff_t>(column));
      }
    });
  }
}

}  // namespace dartcast
