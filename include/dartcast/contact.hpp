// Contacts: what a particle met, where, when, and how the wall moves there.
#pragma once

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
  /// Unit, into the free side. A wall without area, or with a corner outside the exact range, has none of its own: it
  /// has that of the contact's first wall with one; where there is none, it is opposite to the particle's motion.
  Vec3 normal;
};

/// Contacts of a particle less than this share of the step apart count as one place: it has hardly moved. Which walls a
/// response joins depends on it, no decision of a walk.
inline constexpr double share_together = 0x1p-20;

struct Contact {
  std::uint32_t particle = 0;
  Kind kind = Kind::face;  ///< of the place on the wall: face, edge or vertex
  Dart dart;               ///< of that face, edge or vertex, in the free cell at the wall
  std::uint32_t first_wall =
      0;  ///< its walls are walls[first_wall .. first_wall + wall_count) of the list; the one met first
  std::uint32_t wall_count = 0;
  std::uint32_t earlier = 0;    ///< number of walls before those that this particle met earlier in the same step
  std::uint32_t together = 0;   ///< so many of these, the last ones, were met at this place (share_together)
  bool last = false;            ///< no further contact is allowed in this step
  double time_of_impact = 0.0;  ///< fraction of the step, in [0, 1]
  /// On the wall, rounded. The particle is put into the free closed cell there: at most 256 units in the last place of
  /// the point's largest coordinate away; where that cannot be, no farther than where its motion to the wall began.
  Vec3 point;
  Vec3 wall_displacement;  ///< of the wall at that point, over the whole step; zero where the scene stands still
  Vec3 displacement;  ///< of the particle relative to the wall, over the whole of the motion that led to the contact
  Vec3 unused;        ///< displacement not used, relative to the wall
};

/// Contacts of a batch: by particle, then by time.
struct ContactList {
  std::vector<Contact> contacts;
  std::vector<WallHit> walls;

  [[nodiscard]] std::span<const WallHit> walls_of(const Contact& c) const {
    return {walls.data() + c.first_wall, c.wall_count};
  }
  /// Walls that the particle met earlier in the same step, oldest first.
  [[nodiscard]] std::span<const WallHit> earlier_walls_of(const Contact& c) const {
    return {walls.data() + c.first_wall - c.earlier, c.earlier};
  }
  void clear() {
    contacts.clear();
    walls.clear();
  }
  /// Adds a list whose particles come after those here.
  void append(const ContactList& other);
};

/// Of a displacement's largest component: what points into a wall by less than this along its normal is meant to run
/// along it, and rounding is to blame.
inline constexpr double along_share = 4e-12;

/// What a particle does after a contact, in the rest of the step.
struct AfterContact {
  Vec3 displacement;  ///< relative to the wall
  /// Rounding must not turn it into the walls touched in this step that it runs along, or off (along_share). A wall
  /// that it points into is met again.
  bool along = false;
};

/// Decides what follows a contact: given the contact, its walls, and those met earlier in the same step. Called from
/// several threads at once for different particles; an empty function stops the particle at the wall until the end of
/// the step.
using ContactCallback =
    std::function<AfterContact(const Contact&, std::span<const WallHit> walls, std::span<const WallHit> earlier)>;

}  // namespace dartcast
