// Contacts for a solver that takes one after the other, stored so that four are solved at once with the same result.
//
// A contact reads and writes what moves its two bodies, nothing else. So those that share no body may change places, or
// be solved at once, and no bit changes. Each contact is put into the first level behind those of all earlier contacts
// of its bodies; levels are stored one after the other, four contacts to a packet. Forwards or backwards through the
// packets, the result is that of the contacts one by one in the order in which they were given.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/instruction_set.hpp"
#include "dartcast/storage.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::detail {

inline constexpr std::uint32_t packet_lanes = 4;
using PacketNumbers = std::array<double, packet_lanes>;
using PacketVectors = std::array<PacketNumbers, 3>;  // x, y, z

/// A body that contacts act on: a sphere, or a wall, whose inverse mass is 0.
struct alignas(32) ContactBody {
  Vec3 velocity;
  double inverse_mass = 0.0;
};

/// The bodies of a contact: indices.
struct ContactEnds {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  /// Whether it begins with an impulse. Packets of those that have none, and get none, are passed over quickly: in a
  /// level they are stored together. The results do not depend on it.
  bool loaded = false;
};

/// The condition that is solved for: the velocity of b relative to a along the normal must not be below the bound.
struct alignas(64) ContactTerms {
  Vec3 normal;        ///< unit, from a to b
  double mass = 0.0;  ///< 1 / (sum of the inverse masses)
  double friction = 0.0;
  double bound = 0.0;
  double position_bound = 0.0;  ///< the same, for displacements
  double rebound = 0.0;  ///< bound that takes its place after rebound(), if the contact has an impulse; 0: none does
  double normal_impulse = 0.0;  ///< impulse on b that it begins with: along the normal, and across it
  Vec3 tangent_impulse;
};

/// Four contacts: whom they act on, and how. All of this is read in every iteration.
struct alignas(64) ContactPacket {
  std::array<std::uint32_t, packet_lanes> a{};
  std::array<std::uint32_t, packet_lanes> b{};
  PacketVectors normal{};
  PacketNumbers mass{};
  PacketNumbers bound{};
};
/// Their impulses so far.
struct alignas(64) PacketImpulses {
  PacketNumbers normal_impulse{};
  PacketVectors tangent_impulse{};
};
/// Data that is read for contacts with impulses, and at the end.
struct alignas(64) PacketSurfaces {
  PacketNumbers friction{};
  PacketNumbers rebound{};
};
/// Impulses of displacements.
struct alignas(64) PacketCorrections {
  PacketNumbers bound{};
  PacketNumbers position_correction{};
};

class ContactPackets {
 public:
  /// Sorts the contacts into packets; terms: one for each. The last of the bodies must be in no contact and have no
  /// velocity and an inverse mass of 0: it stands for what is missing in packets that are not full. Contacts of a body
  /// whose inverse mass is 0 do not wait for each other. Cost: some 20 ns a contact; no allocation in steady state.
  void assign(std::span<const ContactEnds> contacts, std::span<const ContactTerms> terms,
              std::span<const ContactBody> bodies);

  [[nodiscard]] std::size_t packet_count() const { return packets_.size(); }
  [[nodiscard]] double normal_impulse(std::size_t i) const { return impulses_[packet(i)].normal_impulse[lane(i)]; }
  [[nodiscard]] Vec3 tangent_impulse(std::size_t i) const {
    const PacketVectors& v = impulses_[packet(i)].tangent_impulse;
    return {v[0][lane(i)], v[1][lane(i)], v[2][lane(i)]};
  }
  /// Whether it was given an impulse, and rebounds.
  [[nodiscard]] bool rebounds(std::size_t i) const { return surfaces_[packet(i)].rebound[lane(i)] > 0.0; }

  /// Gives the bodies the impulses that contacts begin with.
  void start(std::span<ContactBody> bodies, InstructionSet set = best_instruction_set());
  /// Solves for velocities. Forwards and backwards in turn, so that an impulse passes through a chain either way; the
  /// last time is forwards. Cost: some 6 ns a contact and iteration.
  void solve(std::span<ContactBody> bodies, unsigned iterations, InstructionSet set = best_instruction_set());
  /// The same for displacements over a unit of time, by impulses along normals that are forgotten.
  void position_correction(std::span<ContactBody> bodies, unsigned iterations,
                           InstructionSet set = best_instruction_set());
  /// From now on those that have an impulse and rebound are bound to do so. Whether there are any.
  bool rebound();

 private:
  static constexpr std::uint32_t nothing = 0xffffffffU;

  [[nodiscard]] std::size_t packet(std::size_t i) const { return places_[i] / packet_lanes; }
  [[nodiscard]] std::size_t lane(std::size_t i) const { return places_[i] % packet_lanes; }
  void find_levels(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies);
  void sort(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies);
  void clear(std::size_t p, std::uint32_t nobody);
  void set(std::size_t p, std::size_t l, const ContactEnds& ends, const ContactTerms& terms);

  AlignedVector<ContactPacket> packets_;
  AlignedVector<PacketImpulses> impulses_;
  AlignedVector<PacketSurfaces> surfaces_;
  AlignedVector<PacketCorrections> corrections_;
  std::vector<std::uint32_t> places_;  // by contact: its part of a level, then packet_lanes * packet + lane
  std::vector<std::uint32_t> order_;   // contacts by place
  std::vector<std::uint32_t> behind_;  // by body: the first level behind its contacts
  std::vector<std::uint32_t> starts_;  // of each level's two parts: those loaded, and others
};

}  // namespace dartcast::detail
