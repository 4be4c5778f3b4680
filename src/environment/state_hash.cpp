// Hashes the states of particles.
#include <fmt/format.h>

#include <bit>
#include <initializer_list>

#include "dartcast/audit.hpp"

namespace dartcast {

namespace {

// The finalizer of SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, 2014): every bit of z reaches every bit of the
// result.
constexpr std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

// One half of a particle's hash: words are mixed in one after another.
class HashLane {
 public:
  explicit constexpr HashLane(std::uint64_t key) : value_(key) {}
  void take(std::uint64_t word) { value_ = mixed(value_ * 0x9e3779b97f4a7c15U + word); }
  void take(const Vec3& v) {
    for (const double x : {v.x, v.y, v.z}) take(std::bit_cast<std::uint64_t>(x));
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

std::uint64_t half(std::uint64_t key, std::uint64_t id, const ParticleState& s, const Vec3& velocity,
                   std::uint64_t fate) {
  HashLane h(key);
  h.take(id);
  h.take(s.position);
  h.take(velocity);
  h.take(std::uint64_t{s.cell.value} << 32U | std::uint64_t{s.simplex} << 16U | std::uint64_t{s.touching_count} << 8U |
         (s.held ? 1U : 0U));
  for (unsigned i = 0; i < s.touching_count; ++i) {
    h.take(std::uint64_t{s.touching[i].cell.value} << 16U | s.touching[i].face);
  }
  h.take(fate);
  return h.value();
}

}  // namespace

void StateHash::add(std::uint64_t id, const ParticleState& state, const Vec3& velocity, std::uint64_t fate) {
  low_ += half(0x6a09e667f3bcc908U, id, state, velocity, fate);
  high_ += half(0xbb67ae8584caa73bU, id, state, velocity, fate);
}

StateHash& StateHash::operator+=(const StateHash& other) {
  low_ += other.low_;
  high_ += other.high_;
  return *this;
}

std::string StateHash::hex() const { return fmt::format("{:016x}{:016x}", high_, low_); }

}  // namespace dartcast
