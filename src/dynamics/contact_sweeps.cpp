// The iterations over packets of contacts, for each instruction set.
#include <cmath>

#include "dynamics/contact_packets.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace dartcast::detail {

namespace {

// How vectors are passed does not matter: no function here is called from elsewhere.
#pragma GCC diagnostic ignored "-Wpsabi"

// Four doubles, and two. Where the instruction set has no such register, the compiler takes two of half the size.
using Double4 = double __attribute__((vector_size(32), may_alias));
using Double2 = double __attribute__((vector_size(16), may_alias));
using Mask4 = long long __attribute__((vector_size(32)));

static_assert(sizeof(ContactBody) == 32);

struct PacketSpans {
  const ContactPacket* packets;
  PacketImpulses* impulses;
  const PacketSurfaces* surfaces;
  PacketCorrections* corrections;
  std::size_t count;
};

// The rows of four bodies, in halves.
struct BodyRows {
  Double2* of[packet_lanes];

  Double2* operator[](std::size_t i) const { return of[i]; }
};
inline BodyRows rows_of(ContactBody* bodies, const std::array<std::uint32_t, packet_lanes>& which) {
  const auto row = [&](std::size_t i) { return reinterpret_cast<Double2*>(bodies + which[i]); };
  return {{row(0), row(1), row(2), row(3)}};
}

namespace portable {

inline bool any(const Mask4& m) { return ((m[0] | m[1]) | (m[2] | m[3])) != 0; }
inline Double4 root(const Double4& x) {
  return Double4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}
inline Double4 join(const Double2& lower, const Double2& upper) {
  return Double4{lower[0], lower[1], upper[0], upper[1]};
}
inline void split(const Double4& x, Double2& lower, Double2& upper) {
  lower = Double2{x[0], x[1]};
  upper = Double2{x[2], x[3]};
}

#define DARTCAST_TARGET
#include "dynamics/contact_packets_kernel.inl"
#undef DARTCAST_TARGET

}  // namespace portable

#if defined(__x86_64__)
namespace avx2 {

#define DARTCAST_TARGET __attribute__((target("avx2")))

DARTCAST_TARGET inline bool any(const Mask4& m) { return _mm256_movemask_pd(reinterpret_cast<__m256d>(m)) != 0; }
DARTCAST_TARGET inline Double4 root(const Double4& x) { return _mm256_sqrt_pd(x); }
DARTCAST_TARGET inline Double4 join(const Double2& lower, const Double2& upper) {
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(lower), upper, 1);
}
DARTCAST_TARGET inline void split(const Double4& x, Double2& lower, Double2& upper) {
  lower = _mm256_castpd256_pd128(x);
  upper = _mm256_extractf128_pd(x, 1);
}

#include "dynamics/contact_packets_kernel.inl"

#undef DARTCAST_TARGET

}  // namespace avx2
#endif

}  // namespace

void ContactPackets::start(std::span<ContactBody> bodies, [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data(), packets_.size()};
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::start_all(spans, bodies.data());
#endif
  portable::start_all(spans, bodies.data());
}

void ContactPackets::solve(std::span<ContactBody> bodies, unsigned iterations, [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data(), packets_.size()};
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::solve_all(spans, bodies.data(), iterations);
#endif
  portable::solve_all(spans, bodies.data(), iterations);
}

void ContactPackets::position_correction(std::span<ContactBody> bodies, unsigned iterations,
                                         [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data(), packets_.size()};
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::correct_all(spans, bodies.data(), iterations);
#endif
  portable::correct_all(spans, bodies.data(), iterations);
}

}  // namespace dartcast::detail
