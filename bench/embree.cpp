// Embree, robust: rays one at a time, or in packets of 16.
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <string>

#include "bench/competitors.hpp"
#include "dartcast/error.hpp"

namespace dartcast::bench {

namespace {

constexpr std::size_t packet = 16;

float single(double x) { return static_cast<float>(x); }

// A device with one thread, so that refits are counted for one. It caps TBB for the whole process, for good.
RTCDevice device() {
  static const RTCDevice one = rtcNewDevice("threads=1");
  if (one == nullptr) throw Error("Embree makes no device: error " + std::to_string(rtcGetDeviceError(nullptr)));
  return one;
}

class Embree : public Competitor {
 public:
  explicit Embree(const PeerScene& scene)
      : scene_(rtcNewScene(device())), geometry_(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE)) {
    const std::vector<std::array<std::uint32_t, 3>>& triangles = scene.walls.triangles;
    // Only dynamic scenes of low quality are refitted; others are built anew.
    rtcSetSceneFlags(scene_, scene.deforms ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, scene.deforms ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_HIGH);
    rtcSetGeometryBuildQuality(geometry_, scene.deforms ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_HIGH);
    points_ = static_cast<std::array<float, 3>*>(rtcSetNewGeometryBuffer(
        geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(std::array<float, 3>), scene.points.size()));
    void* const indices = rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                  sizeof(triangles[0]), triangles.size());
    check();
    std::copy(triangles.begin(), triangles.end(), static_cast<std::array<std::uint32_t, 3>*>(indices));
    write(scene.points);
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
    check();
  }
  ~Embree() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
  }

  void write(std::span<const Vec3> points) override {
    for (std::size_t i = 0; i < points.size(); ++i)
      points_[i] = {single(points[i].x), single(points[i].y), single(points[i].z)};
  }

  void refit() override {
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

 protected:
  static void check() {
    const RTCError error = rtcGetDeviceError(device());
    if (error != RTC_ERROR_NONE) throw Error("Embree fails with error " + std::to_string(error));
  }

  RTCScene scene_;

 private:
  RTCGeometry geometry_;
  std::array<float, 3>* points_ = nullptr;
};

class Single : public Embree {
 public:
  using Embree::Embree;

  void cast(std::span<const Segment> segments, std::span<Hit> hits) override {
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const Vec3& p = segments[i].from;
      const Vec3 d = segments[i].to - p;
      RTCRayHit r{};
      r.ray = {single(p.x), single(p.y), single(p.z), single(segments[i].self_hit_epsilon),
               single(d.x), single(d.y), single(d.z), 0.0F,
               1.0F,        ~0U,         0,           0};
      r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene_, &context, &r);
      hits[i] = r.hit.geomID == RTC_INVALID_GEOMETRY_ID ? Hit{} : Hit{r.hit.primID, static_cast<double>(r.ray.tfar)};
    }
  }
};

class Packet : public Embree {
 public:
  using Embree::Embree;

  void cast(std::span<const Segment> segments, std::span<Hit> hits) override {
    for (std::size_t first = 0; first < segments.size(); first += packet) {
      const std::size_t count = std::min(packet, segments.size() - first);
      cast_packet(segments.subspan(first, count), hits.subspan(first, count));
    }
  }

 private:
  void cast_packet(std::span<const Segment> segments, std::span<Hit> hits) {
    alignas(64) std::array<int, packet> valid{};
    RTCRayHit16 r{};
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const Vec3& p = segments[i].from;
      const Vec3 d = segments[i].to - p;
      valid[i] = -1;
      r.ray.org_x[i] = single(p.x);
      r.ray.org_y[i] = single(p.y);
      r.ray.org_z[i] = single(p.z);
      r.ray.dir_x[i] = single(d.x);
      r.ray.dir_y[i] = single(d.y);
      r.ray.dir_z[i] = single(d.z);
      r.ray.tnear[i] = single(segments[i].self_hit_epsilon);
      r.ray.tfar[i] = 1.0F;
      r.ray.mask[i] = ~0U;
      r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect16(valid.data(), scene_, &context, &r);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const bool met = r.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      hits[i] = met ? Hit{r.hit.primID[i], static_cast<double>(r.ray.tfar[i])} : Hit{};
    }
  }
};

}  // namespace

std::unique_ptr<Competitor> make_embree_single(const PeerScene& scene) { return std::make_unique<Single>(scene); }

std::unique_ptr<Competitor> make_embree_packet(const PeerScene& scene) { return std::make_unique<Packet>(scene); }

}  // namespace dartcast::bench
