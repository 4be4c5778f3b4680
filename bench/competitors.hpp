// The competitors that this build has.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/competitor.hpp"
#include "bench/walls.hpp"

namespace dartcast::bench {

/// The scene that a competitor is made for. Complex and walls outlive it.
struct PeerScene {
  const CellComplex& complex;
  const Walls& walls;
  std::span<const Vec3> points;              ///< of the walls, now
  std::span<const ParticleState> particles;  ///< now
  bool deforms = false;                      ///< it will be refitted
};

std::unique_ptr<Competitor> make_bullet(const PeerScene& scene);
/// One ray at a time (rtcIntersect1), and 16 at a time (rtcIntersect16).
std::unique_ptr<Competitor> make_embree_single(const PeerScene& scene);
std::unique_ptr<Competitor> make_embree_packet(const PeerScene& scene);
/// The scheme of Jund, Cazier and Dufourd (2009), as published: in space, or in the plane.
std::unique_ptr<Competitor> make_paper(const PeerScene& scene);

struct PeerKind {
  std::string name;  ///< as in reports: "bullet", "embree_single", "embree_packet", "paper"
  std::unique_ptr<Competitor> (*make)(const PeerScene& scene);
  bool in_plane = false;  ///< has an answer where the scene is of the plane, too
};

/// Those built in.
std::vector<PeerKind> competitor_kinds();
/// Libraries that were not there when this was built, each with how to get it; for people.
std::vector<std::string> left_out();

}  // namespace dartcast::bench
