#include "dynamics/places_between.hpp"

#include <algorithm>

#include "tracking/space.hpp"

namespace dartcast {

void PlacesBetween::start(const CellComplex& complex, double begin, double end) {
  complex_ = &complex;
  begin_ = begin;
  end_ = end;
  const std::size_t count = complex.positions().size();
  if (known_.size() != count || ++round_ == 0) {
    known_.assign(count, 0);
    before_.resize(count);
    after_.resize(count);
    round_ = 1;
  }
}

void PlacesBetween::reach(std::span<const std::uint32_t> vertices) {
  const Vec3* from = complex_->previous_positions().data();
  const Vec3* to = complex_->positions().data();
  const bool plane = complex_->map().dimension() == 2;
  for (const std::uint32_t v : vertices) {
    if (known_[v] == round_) continue;
    known_[v] = round_;
    before_[v] = Between{from, to, begin_}[Vertex{v}];
    after_[v] = Between{from, to, end_}[Vertex{v}];
    if (plane) before_[v].z = after_[v].z = 0.0;
  }
}

}  // namespace dartcast
