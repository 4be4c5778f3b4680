// Contacts: which walls a particle meets, where and when, and how the walls move there.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dartcast/ids.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A wall that meets at a contact: a fan triangle of a wall face, seen from the free side.
struct WallHit {
  CellFace face;               ///< of the free cell
  std::uint16_t triangle = 0;  ///< in the face's fan
  Patch patch;
  /// Unit vector into the free side. Some walls have no normal of their own: those without area, and those with a
  /// corner outside the exact range. They get the normal of the contact's first wall that has one. If none has one, the
  /// normal is opposite to the particle's motion.
  Vec3 normal;
};

/// Contacts of a particle that are less than this share of the step apart count as one place: the particle has hardly
/// moved. Only responses use it, to join walls. No decision of a walk depends on it.
inline constexpr double share_together = 0x1p-20;

/// A particle that meets one or more walls: where, when, and the rest of its motion.
struct Contact {
  std::uint32_t particle = 0;
  Kind kind = Kind::face;  ///< kind of the place on the wall: face, edge or vertex
  Dart dart;               ///< of that face, edge or vertex, in the free cell at the wall
  std::uint32_t first_wall =
      0;  ///< its walls are walls[first_wall .. first_wall + wall_count) of the list; the one met first
  std::uint32_t wall_count = 0;
  std::uint32_t earlier = 0;    ///< number of walls in front of these that the particle met earlier in this step
  std::uint32_t together = 0;   ///< number of those, the last ones, that were met at this place (share_together)
  bool last = false;            ///< no further contact is allowed in this step
  double time_of_impact = 0.0;  ///< fraction of the step, in [0, 1]; that of a particle's contacts never falls
  /// On the wall, rounded. The particle is put into the free closed cell there. It is at most 256 units in the last
  /// place of the point's largest coordinate away, or 256 times 2^-300 if that is more. If that is impossible, it
  /// is no farther away than the start of its motion to the wall.
  Vec3 point;
  Vec3 wall_displacement;  ///< motion of the wall at that point over the whole step; zero in a scene at rest
  Vec3 displacement;       ///< motion that led to the contact, relative to the wall, up to its planned end
  Vec3 unused;             ///< the remaining part of `displacement`, relative to the wall
};

/// A particle that passes from a wall face of a periodic pair to the face's partner (PeriodicPair,
/// dartcast/mesh_data.hpp). It is no contact.
struct PeriodicCrossing {
  std::uint32_t particle = 0;
  std::uint16_t pair = 0;      ///< its number in MeshData::periodic
  bool back = false;           ///< from b to a
  std::uint32_t contacts = 0;  ///< number of the particle's contacts in this step before it
  double time = 0.0;           ///< fraction of the step, in [0, 1]
  CellFace from;               ///< the face that it leaves through, in its cell
  CellFace to;                 ///< the partner
  Vec3 point;                  ///< where the particle is then, at the partner
  /// Rows of the rotation that takes vectors from one side to the other; ones on the diagonal for a translation.
  std::array<Vec3, 3> turn = {Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}};
};

/// Contacts of a batch: by particle, then by time.
struct ContactList {
  std::vector<Contact> contacts;
  std::vector<WallHit> walls;
  std::vector<PeriodicCrossing> crossings;  ///< by particle, then by time; empty without periodic pairs

  [[nodiscard]] std::span<const WallHit> walls_of(const Contact& c) const {
    return {walls.data() + c.first_wall, c.wall_count};
  }
  /// The walls that the particle met earlier in the same step, oldest first.
  [[nodiscard]] std::span<const WallHit> earlier_walls_of(const Contact& c) const {
    return {walls.data() + c.first_wall - c.earlier, c.earlier};
  }
  void clear() {
    contacts.clear();
    walls.clear();
    crossings.clear();
  }
  /// Adds a list whose particles come after those here.
  void append(const ContactList& other);
};

/// A share of a displacement's largest component. If a displacement points into a wall by less than this along its
/// normal, it is meant to run along the wall. The difference is rounding.
inline constexpr double along_share = 4e-12;

/// The motion of a particle after a contact, in the rest of the step.
struct AfterContact {
  Vec3 displacement;  ///< relative to the wall
  /// Whether the displacement runs along walls. Then rounding cannot turn it into the walls touched in this step that
  /// it runs along or points away from (along_share). A wall that it points into is met again.
  bool along = false;
};

/// Decides what follows a contact. It gets the contact, its walls, and the walls met earlier in the same step. It is
/// called from several threads at once for different particles. An AfterContact{} lets the particle stay at the wall,
/// and move with it, until the end of the step. An empty function also stops it there: then the report names it with its
/// unused displacement.
using ContactCallback =
    std::function<AfterContact(const Contact&, std::span<const WallHit> walls, std::span<const WallHit> earlier)>;

/// Is called at each periodic crossing, before the particle goes on: a response that knows velocities turns them here. It
/// is called from several threads at once for different particles. It must not throw.
using CrossingCallback = std::function<void(const PeriodicCrossing&)>;

/// Decides what follows the contacts of a round: the next contact of each particle that still has one. It gets them by
/// particle, at most one for each; ContactList::walls_of() and earlier_walls_of() give their walls. It writes the answer
/// to contacts.contacts[i] to after[i], which is AfterContact{} before. The particle stays at the wall, and moves with
/// it, until the end of the step. It is called from the thread of the caller. The list and the span are valid until it
/// returns. It must not change the environment or the particles.
using RoundCallback = std::function<void(const ContactList& contacts, std::span<AfterContact> after)>;

}  // namespace dartcast
