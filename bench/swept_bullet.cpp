// Bullet's dynamic tree of boxes (btDbvt), a leaf for each wall: the broad phase of a moving scene.
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/solids.hpp"

namespace dartcast::bench {

namespace {

// Rounded outwards, because Bullet's numbers may be floats.
btDbvtVolume volume(const Vec3& low, const Vec3& high) {
  const auto down = [](double x) {
    return std::nextafter(static_cast<btScalar>(x), -std::numeric_limits<btScalar>::max());
  };
  const auto up = [](double x) {
    return std::nextafter(static_cast<btScalar>(x), std::numeric_limits<btScalar>::max());
  };
  return btDbvtVolume::FromMM({down(low.x), down(low.y), down(low.z)}, {up(high.x), up(high.y), up(high.z)});
}

btDbvtVolume volume(const MovingTriangle& w) {
  Vec3 low = w.from[0];
  Vec3 high = low;
  for (const auto& corners : {w.from, w.to}) {
    for (const Vec3& p : corners) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return volume(low, high);
}

struct Collect : btDbvt::ICollide {
  std::vector<std::size_t> found;
  void Process(const btDbvtNode* leaf) override { found.push_back(*static_cast<const std::size_t*>(leaf->data)); }
};

class BulletTree final : public SweptTree {
 public:
  void fit(std::span<const MovingTriangle> walls) override {
    if (leaves_.empty()) {
      numbers_.resize(walls.size());
      for (std::size_t i = 0; i < walls.size(); ++i) {
        numbers_[i] = i;
        leaves_.push_back(tree_.insert(volume(walls[i]), &numbers_[i]));
      }
      tree_.optimizeTopDown();
      return;
    }
    for (std::size_t i = 0; i < walls.size(); ++i) {
      btDbvtVolume box = volume(walls[i]);
      tree_.update(leaves_[i], box);
    }
  }
  std::span<const std::size_t> query(const Vec3& low, const Vec3& high) override {
    collect_.found.clear();
    tree_.collideTV(tree_.m_root, volume(low, high), collect_);
    return collect_.found;
  }

 private:
  btDbvt tree_;
  std::vector<std::size_t> numbers_;  // that leaves point to
  std::vector<btDbvtNode*> leaves_;
  Collect collect_;
};

}  // namespace

std::unique_ptr<SweptTree> make_swept_tree() { return std::make_unique<BulletTree>(); }

}  // namespace dartcast::bench
