// Solves packets of four contacts, one contact in each lane. Compiled once for each instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/double4.inl"
#include "dynamics/contact_packets.hpp"
#include "dynamics/contact_sweeps.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline Double4 load(const PacketNumbers& numbers) { return load_doubles(numbers.data()); }
inline Vec3x4 load(const PacketVectors& v) { return {load(v[0]), load(v[1]), load(v[2])}; }
inline void store(const Double4& four, PacketNumbers& to) { store_doubles(four, to.data()); }

// Four bodies as rows of numbers: velocity and inverse mass.
struct BodyRows {
  double* row[packet_lanes];

  BodyRows(ContactBody* bodies, const std::array<std::uint32_t, packet_lanes>& which) {
    static_assert(sizeof(ContactBody) == 4 * sizeof(double));
    for (std::size_t i = 0; i < packet_lanes; ++i) row[i] = reinterpret_cast<double*>(bodies + which[i]);
  }
};

// One side of four contacts.
struct ContactSide {
  Vec3x4 velocity;
  Double4 inverse_mass;

  // Rows are loaded by halves: the upper half of a register comes from memory for the price of a load.
  explicit ContactSide(const BodyRows& bodies) {
    const auto& row = bodies.row;
    const Double4 xy02 = load_pairs(row[0], row[2]);
    const Double4 xy13 = load_pairs(row[1], row[3]);
    const Double4 zw02 = load_pairs(row[0] + 2, row[2] + 2);
    const Double4 zw13 = load_pairs(row[1] + 2, row[3] + 2);
    velocity = {shuffled<0, 4, 2, 6>(xy02, xy13), shuffled<1, 5, 3, 7>(xy02, xy13), shuffled<0, 4, 2, 6>(zw02, zw13)};
    inverse_mass = shuffled<1, 5, 3, 7>(zw02, zw13);
  }

  void write(const BodyRows& bodies) const {
    const auto& row = bodies.row;
    store_pairs(shuffled<0, 4, 2, 6>(velocity.x, velocity.y), row[0], row[2]);
    store_pairs(shuffled<1, 5, 3, 7>(velocity.x, velocity.y), row[1], row[3]);
    store_pairs(shuffled<0, 4, 2, 6>(velocity.z, inverse_mass), row[0] + 2, row[2] + 2);
    store_pairs(shuffled<1, 5, 3, 7>(velocity.z, inverse_mass), row[1] + 2, row[3] + 2);
  }
};

inline Double4 positive_part(const Double4& x) { return choose(x > 0.0, x, Double4{}); }

// Impulses on the spheres b, and the opposite ones on a.
inline void apply(const Vec3x4& impulse, ContactSide& a, ContactSide& b, const BodyRows& a_rows,
                  const BodyRows& b_rows) {
  a.velocity = a.velocity - impulse * a.inverse_mass;
  b.velocity = b.velocity + impulse * b.inverse_mass;
  a.write(a_rows);
  b.write(b_rows);
}

inline void start_packet(const ContactPacket& p, const PacketImpulses& impulses, ContactBody* bodies) {
  const Double4 normal_impulse = load(impulses.normal_impulse);
  if (!any(normal_impulse > 0.0)) return;
  const BodyRows a_rows(bodies, p.a);
  const BodyRows b_rows(bodies, p.b);
  ContactSide a(a_rows);
  ContactSide b(b_rows);
  apply(load(p.normal) * normal_impulse + load(impulses.tangent_impulse), a, b, a_rows, b_rows);
}

// The friction impulse is perpendicular to the normal, so that it does not change the normal velocity. It is at most
// the coefficient of friction times the normal impulse.
inline void solve_packet(const ContactPacket& p, PacketImpulses& impulses, const PacketSurfaces& surfaces,
                         ContactBody* bodies) {
  const BodyRows a_rows(bodies, p.a);
  const BodyRows b_rows(bodies, p.b);
  ContactSide a(a_rows);
  ContactSide b(b_rows);
  const Vec3x4 relative = b.velocity - a.velocity;
  const Vec3x4 normal = load(p.normal);
  const Double4 mass = load(p.mass);
  const Double4 nearing = dot(relative, normal);
  const Double4 along_before = load(impulses.normal_impulse);
  const Double4 normal_impulse = positive_part(along_before - mass * (nearing - load(p.bound)));
  if (!any(normal_impulse + along_before > 0.0)) return;
  const Vec3x4 across_before = load(impulses.tangent_impulse);
  Vec3x4 tangent_impulse = across_before - (relative - normal * nearing) * mass;
  const Double4 limit = load(surfaces.friction) * normal_impulse;
  const Double4 square = dot(tangent_impulse, tangent_impulse);
  const Mask4 slips = square > limit * limit;
  if (any(slips)) tangent_impulse = tangent_impulse * choose(slips, limit / root(square), 1.0 + Double4{});
  apply((tangent_impulse - across_before) + normal * (normal_impulse - along_before), a, b, a_rows, b_rows);
  store(normal_impulse, impulses.normal_impulse);
  store(tangent_impulse.x, impulses.tangent_impulse[0]);
  store(tangent_impulse.y, impulses.tangent_impulse[1]);
  store(tangent_impulse.z, impulses.tangent_impulse[2]);
}

inline void correct_packet(const ContactPacket& p, PacketCorrections& corrections, ContactBody* bodies) {
  const BodyRows a_rows(bodies, p.a);
  const BodyRows b_rows(bodies, p.b);
  ContactSide a(a_rows);
  ContactSide b(b_rows);
  const Vec3x4 normal = load(p.normal);
  const Double4 before = load(corrections.position_correction);
  const Double4 nearing = dot(b.velocity - a.velocity, normal);
  const Double4 position_correction = positive_part(before - load(p.mass) * (nearing - load(corrections.bound)));
  if (!any(position_correction != before)) return;
  store(position_correction, corrections.position_correction);
  apply(normal * (position_correction - before), a, b, a_rows, b_rows);
}

}  // namespace

void start_packets(const PacketSpans& s, ContactBody* bodies, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) start_packet(s.packets[i], s.impulses[i], bodies);
}

void solve_packets(const PacketSpans& s, ContactBody* bodies, std::size_t begin, std::size_t end, bool forwards) {
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t k = forwards ? i : begin + end - 1 - i;
    solve_packet(s.packets[k], s.impulses[k], s.surfaces[k], bodies);
  }
}

void correct_packets(const PacketSpans& s, ContactBody* bodies, std::size_t begin, std::size_t end, bool forwards) {
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t k = forwards ? i : begin + end - 1 - i;
    correct_packet(s.packets[k], s.corrections[k], bodies);
  }
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
