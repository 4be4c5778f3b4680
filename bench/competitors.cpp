#include "bench/competitors.hpp"

namespace dartcast::bench {

std::vector<PeerKind> competitor_kinds() {
  std::vector<PeerKind> kinds;
#ifdef DARTCAST_BENCH_BULLET
  kinds.push_back({"bullet", make_bullet});
#endif
#ifdef DARTCAST_BENCH_EMBREE
  kinds.push_back({"embree_single", make_embree_single});
  kinds.push_back({"embree_packet", make_embree_packet});
#endif
  kinds.push_back({"paper", make_paper, true});
  return kinds;
}

std::vector<std::string> left_out() {
  std::vector<std::string> names;
#ifndef DARTCAST_BENCH_BULLET
  names.emplace_back("Bullet (libbullet-dev was not found when this was built)");
#endif
#ifndef DARTCAST_BENCH_EMBREE
  names.emplace_back("Embree (libembree-dev was not found when this was built)");
#endif
  return names;
}

}  // namespace dartcast::bench
