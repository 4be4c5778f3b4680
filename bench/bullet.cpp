// Bullet: a quantized tree over all triangles, cast against as its rigid bodies' rays are, without the world around it.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>

#include <algorithm>
#include <vector>

#include "bench/competitors.hpp"

namespace dartcast::bench {

namespace {

// A node of the quantized tree has 21 bits for a triangle's number in its part.
constexpr std::size_t part_size = std::size_t{1} << 21U;

btVector3 vector_of(const Vec3& p) {
  return {static_cast<btScalar>(p.x), static_cast<btScalar>(p.y), static_cast<btScalar>(p.z)};
}

class Nearest : public btTriangleRaycastCallback {
 public:
  Nearest(const btVector3& from, const btVector3& to, btScalar self_hit_epsilon)
      : btTriangleRaycastCallback(from, to), self_hit_epsilon_(self_hit_epsilon) {}

  btScalar reportHit(const btVector3& /*normal*/, btScalar fraction, int part, int triangle) override {
    if (fraction < self_hit_epsilon_) return m_hitFraction;
    hit = {static_cast<std::uint32_t>(static_cast<std::size_t>(part) * part_size + static_cast<std::size_t>(triangle)),
           static_cast<double>(fraction)};
    return fraction;
  }

  Hit hit;

 private:
  btScalar self_hit_epsilon_;
};

class Bullet : public Competitor {
 public:
  explicit Bullet(const PeerScene& scene) : triangles_(scene.walls.triangles), points_(scene.points.size()) {
    write(scene.points);
    for (std::size_t first = 0; first < triangles_.size(); first += part_size) add_part(first);
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&mesh_, true, low_, high_, true);
  }

  void write(std::span<const Vec3> points) override {
    for (std::size_t i = 0; i < points.size(); ++i) points_[i] = vector_of(points[i]);
    low_ = high_ = points_.front();
    for (const btVector3& p : points_) {
      low_.setMin(p);
      high_.setMax(p);
    }
  }

  void refit() override { shape_->getOptimizedBvh()->refit(&mesh_, low_, high_); }

  void cast(std::span<const Segment> segments, std::span<Hit> hits) override {
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const btVector3 from = vector_of(segments[i].from);
      const btVector3 to = vector_of(segments[i].to);
      Nearest nearest(from, to, static_cast<btScalar>(segments[i].self_hit_epsilon));
      shape_->performRaycast(&nearest, from, to);
      hits[i] = nearest.hit;
    }
  }

 private:
  void add_part(std::size_t first) {
    btIndexedMesh part;
    part.m_numTriangles = static_cast<int>(std::min(part_size, triangles_.size() - first));
    part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(triangles_.data() + first);
    part.m_triangleIndexStride = sizeof(triangles_[0]);
    part.m_numVertices = static_cast<int>(points_.size());
    part.m_vertexBase = reinterpret_cast<const unsigned char*>(points_.data());
    part.m_vertexStride = sizeof(btVector3);
    mesh_.addIndexedMesh(part, PHY_INTEGER);
  }

  const std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<btVector3> points_;
  btVector3 low_, high_;
  btTriangleIndexVertexArray mesh_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
};

}  // namespace

std::unique_ptr<Competitor> make_bullet(const PeerScene& scene) { return std::make_unique<Bullet>(scene); }

}  // namespace dartcast::bench
