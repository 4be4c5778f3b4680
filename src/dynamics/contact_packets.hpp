// Contacts of a sequential solver, stored so that four are solved at once, and parts of them by several threads.
//
// A contact reads and writes the velocities of its two bodies alone. So contacts that share no body may change
// places, or be solved at once, and no bit changes. Each contact is put into the first level behind those of all
// earlier contacts of its bodies. Levels are stored one after the other, four contacts to a packet. Forwards or
// backwards through the packets, the result is that of the contacts one by one, in the order of the caller.
//
// If bodies are divided into regions, the contacts within each region are a part that is solved beside the others.
// Those between regions are the last part, which is solved behind them. In a part the order is that of the caller.
// Regions are slices of space, so few contacts are in the last part, and impulses pass through a region in one
// iteration. Groups of contacts without a common body ("colours") would have no serial part, but a heap of 10^4 spheres
// then overlaps nine times as deep. An impulse passes one contact in an iteration.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/instruction_set.hpp"
#include "base/parallel.hpp"
#include "dartcast/storage.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::detail {

inline constexpr std::uint32_t packet_lanes = 4;
using PacketNumbers = std::array<double, packet_lanes>;
using PacketVectors = std::array<PacketNumbers, 3>;  // x, y, z

/// A sphere, or a wall, whose inverse mass is 0.
struct alignas(32) ContactBody {
  Vec3 velocity;
  double inverse_mass = 0.0;
};

/// The bodies of a contact: indices.
struct ContactEnds {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  /// Whether it starts with an impulse. A level stores the contacts without one together, because packets that have
  /// none and get none are quick. The results do not depend on it.
  bool loaded = false;
};

/// The constraint: the velocity of b relative to a along the normal must not be below the bound.
struct alignas(64) ContactTerms {
  Vec3 normal;        ///< unit, from a to b
  double mass = 0.0;  ///< 1 / (sum of the inverse masses)
  double friction = 0.0;
  double bound = 0.0;
  double position_bound = 0.0;  ///< the same, for displacements
  double rebound = 0.0;         ///< bound that replaces it after rebound(), if the contact has an impulse; 0: none
  double normal_impulse = 0.0;  ///< impulse on b at the start: along the normal, and across it
  Vec3 tangent_impulse;
};

/// Four contacts: their bodies and terms. Every iteration reads all of this.
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
/// The terms that only contacts with impulses, and the end of the step, need.
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
  /// Sorts the contacts into packets; one of the terms for each. `regions`: of each body, for those that move, below
  /// `region_count`; not read if that is 1. The last region_count + 1 bodies fill packets that are not full. They
  /// must be in no contact, and have no velocity and an inverse mass of 0. Contacts of a body whose inverse mass is 0
  /// do not wait for each other. If there are regions, such a body is in one contact at most. Cost: some 20 ns a
  /// contact; no allocation in steady state.
  void assign(std::span<const ContactEnds> contacts, std::span<const ContactTerms> terms,
              std::span<const ContactBody> bodies, std::span<const std::uint8_t> regions, std::size_t region_count,
              Threads threads);

  [[nodiscard]] std::size_t packet_count() const { return packets_.size(); }
  [[nodiscard]] double normal_impulse(std::size_t i) const { return impulses_[packet(i)].normal_impulse[lane(i)]; }
  [[nodiscard]] Vec3 tangent_impulse(std::size_t i) const {
    const PacketVectors& v = impulses_[packet(i)].tangent_impulse;
    return {v[0][lane(i)], v[1][lane(i)], v[2][lane(i)]};
  }
  /// Whether the contact got an impulse and rebounds.
  [[nodiscard]] bool rebounds(std::size_t i) const { return surfaces_[packet(i)].rebound[lane(i)] > 0.0; }

  /// Applies the impulses that contacts start with.
  void start(std::span<ContactBody> bodies, Threads threads, InstructionSet set = best_instruction_set());
  /// Solves for velocities, forwards and backwards in turn, so that an impulse passes through a chain either way. The
  /// last pass is forwards. Cost: some 6 ns a contact and iteration.
  void solve(std::span<ContactBody> bodies, unsigned iterations, Threads threads,
             InstructionSet set = best_instruction_set());
  /// The same for displacements over a unit of time, with impulses along normals that are not kept.
  void position_correction(std::span<ContactBody> bodies, unsigned iterations, Threads threads,
                           InstructionSet set = best_instruction_set());
  /// Replaces the bounds of contacts that have an impulse and rebound. Returns whether there are any.
  bool rebound();

  static constexpr std::uint32_t nothing = 0xffffffffU;

 private:
  // The contacts within a region, or those between regions.
  struct Part {
    std::size_t begin = 0;  // packets
    std::size_t end = 0;
    std::uint32_t levels = 0;
    std::uint32_t first_level = 0;  // among those of all parts
  };
  struct Place {
    std::uint32_t part = 0;
    std::uint32_t level = 0;
  };

  [[nodiscard]] std::size_t packet(std::size_t i) const { return places_[i] / packet_lanes; }
  [[nodiscard]] std::size_t lane(std::size_t i) const { return places_[i] % packet_lanes; }
  void find_parts(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies,
                  std::span<const std::uint8_t> regions);
  void find_levels(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies);
  void sort(std::span<const ContactEnds> contacts);
  void fill(std::size_t begin, std::size_t end, std::uint32_t nobody, std::span<const ContactEnds> contacts,
            std::span<const ContactTerms> terms);
  template <class Sweep>
  void sweep(unsigned iterations, Threads threads, Sweep&& one);
  void clear(std::size_t p, std::uint32_t nobody);
  void set(std::size_t p, std::size_t l, const ContactEnds& ends, const ContactTerms& terms);

  AlignedVector<ContactPacket> packets_;
  AlignedVector<PacketImpulses> impulses_;
  AlignedVector<PacketSurfaces> surfaces_;
  AlignedVector<PacketCorrections> corrections_;
  std::vector<std::uint32_t> places_;  // by contact: packet_lanes * packet + lane
  std::vector<std::uint32_t> order_;   // contacts by place
  std::vector<Place> levels_;          // by contact
  std::vector<std::uint32_t> behind_;  // by body: the first level behind its contacts in its part
  std::vector<std::uint8_t> between_;  // by body: whether it has a contact between regions
  std::vector<std::uint32_t> starts_;  // of each level's two parts: those loaded, and others
  std::vector<Part> parts_ = {{}};     // regions, then contacts between them
  std::vector<std::size_t> counts_;    // of parts, by stage of all iterations
};

}  // namespace dartcast::detail
