// Reads the keys of a group of particles: where they start or enter, when, and how fast.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "scene/scene_keys.hpp"

namespace dartcast {

namespace {

InletCone read_cone(TomlTable t) {
  InletCone cone;
  t.require("at", "the point that particles start from, as [0, 0, 0]");
  t.get("at", cone.at);
  t.get("axis", cone.axis);
  if (cone.axis == Vec3()) t.fail("axis", "axis must not be [0, 0, 0]");
  t.get("inner", cone.inner, {0.0, 180.0});
  t.get("outer", cone.outer, {cone.inner, 180.0});
  if (cone.outer < cone.inner) t.fail("inner", fmt::format("inner = {}: give an outer that is not less", cone.inner));
  t.require("speed", "m/s");
  t.get("speed", cone.speed, Range::not_negative);
  t.finish();
  return cone;
}

Waveform read_waveform(TomlTable t) {
  Waveform waveform;
  t.require("times", "times in seconds, increasing");
  t.require("factors", "a factor of the rate for each time");
  t.get("times", waveform.times);
  t.get("factors", waveform.factors);
  t.get("period", waveform.period, Range::positive);
  if (waveform.times.size() != waveform.factors.size() || waveform.times.empty())
    t.fail("factors", fmt::format("there are {} factors for {} times", waveform.factors.size(), waveform.times.size()));
  t.finish();
  return waveform;
}

void read_bursts(TomlTable t, InletParticles& inlet) {
  t.require("times", "the times of the bursts in seconds");
  t.require("count", "the number of particles in each");
  t.get("times", inlet.burst_times);
  t.get("count", inlet.burst_count, 0, 0xfffffffeU);
  t.finish();
}

// Keys that an inlet or a cone has.
void read_flow(TomlTable& t, InletParticles& inlet) {
  const bool enters = inlet.cone || !inlet.patch.empty();
  const bool has_mass_rate = t.get("mass_rate", inlet.mass_rate, Range::not_negative);
  const bool has_rate = t.get("rate", inlet.rate, Range::not_negative) || has_mass_rate;
  if (has_mass_rate && t.has("rate")) t.fail("mass_rate", "give rate or mass_rate, not both");
  const bool has_bursts = t.has("bursts");
  if (has_bursts) read_bursts(t.table("bursts"), inlet);
  if (enters && !has_rate && !has_bursts)
    t.fail("", "an inlet or a cone needs rate (particles per second) or mass_rate, bursts, or both");
  if (t.has("waveform")) {
    if (!has_rate) t.fail("waveform", "waveform is about a rate: give rate");
    inlet.waveform = read_waveform(t.table("waveform"));
  }
  const bool has_profile =
      t.get("profile", inlet.profile, {{"uniform", InletProfile::uniform}, {"flux", InletProfile::flux}});
  if (has_profile && inlet.patch.empty()) t.fail("profile", "profile belongs to an inlet");
  if (!enters && (has_rate || has_bursts))
    t.fail(has_mass_rate ? "mass_rate"
           : has_rate    ? "rate"
                         : "bursts",
           "rate or bursts, and an inlet or a cone belong together");
}

// A vector, or "field".
void read_velocity(TomlTable& t, ParticlesScene& scene, const InletParticles& inlet) {
  if (!t.has("velocity")) return;
  if (inlet.cone) t.fail("velocity", "a cone gives its particles their velocities: leave velocity out");
  if (inlet.profile == InletProfile::flux)
    t.fail("velocity", "profile = \"flux\" gives particles the field's velocity: leave velocity out");
  if (!t.is_text("velocity")) {
    t.get("velocity", scene.velocity);
    return;
  }
  bool with_field = false;
  t.get("velocity", with_field, {{"field", true}});
  scene.with_field = with_field;
}

// The names of a distribution's numbers, by its law.
struct SizeKeys {
  const char* size;
  const char* spread;
};
SizeKeys keys_of(SizeLaw law) {
  switch (law) {
    case SizeLaw::normal: return {"mean", "deviation"};
    case SizeLaw::lognormal: return {"median", "deviation"};
    case SizeLaw::rosin_rammler: return {"scale", "exponent"};
    case SizeLaw::table: break;
  }
  return {"diameters", "shares"};
}

SizeDistribution read_sizes(TomlTable t) {
  SizeDistribution sizes;
  t.require("law", "normal, lognormal, rosin-rammler or table");
  t.get("law", sizes.law,
        {{"normal", SizeLaw::normal},
         {"lognormal", SizeLaw::lognormal},
         {"rosin-rammler", SizeLaw::rosin_rammler},
         {"table", SizeLaw::table}});
  const SizeKeys keys = keys_of(sizes.law);
  t.require(keys.size, sizes.law == SizeLaw::table ? "metres" : "m");
  t.require(keys.spread, "see docs/scene.md");
  if (sizes.law == SizeLaw::table) {
    t.get(keys.size, sizes.diameters);
    t.get(keys.spread, sizes.shares);
    if (sizes.diameters.empty() || sizes.diameters.size() != sizes.shares.size())
      t.fail("shares",
             fmt::format("there are {} shares for {} diameters", sizes.shares.size(), sizes.diameters.size()));
  } else {
    t.get(keys.size, sizes.size, Range::positive);
    t.get(keys.spread, sizes.spread, Range::positive);
    t.get("min", sizes.min, Range::not_negative);
    t.get("max", sizes.max, Range::positive);
  }
  t.finish();
  return sizes;
}

void read_material(TomlTable& t, ParticlesScene& scene) {
  if (t.is_table("diameter"))
    scene.sizes = read_sizes(t.table("diameter"));
  else
    t.get("diameter", scene.material.diameter, Range::positive);
  t.get("density", scene.material.density, Range::positive);
  t.get("charge_per_mass", scene.material.charge_per_mass, {-Range::unlimited, Range::unlimited});
  t.get("number", scene.number, 1, 0xffffffffU);
  if (t.get("interception", scene.interception) && t.has("radius"))
    t.fail("interception", "interception takes the radius from the diameter: leave radius out");
}

}  // namespace

ParticlesScene read_particles(TomlTable& t, const std::filesystem::path& folder) {
  ParticlesScene scene;
  t.get("radius", scene.radius, Range::not_negative);
  read_material(t, scene);
  std::uint64_t count = 0;
  std::string positions;
  InletParticles inlet;
  const bool has_cone = t.has("cone");
  const int sources = (t.get("count", count, 0, 0xfffffffeU) ? 1 : 0) + (t.get("positions", positions) ? 1 : 0) +
                      (t.get("inlet", inlet.patch) ? 1 : 0) + (has_cone ? 1 : 0);
  if (sources != 1) t.fail("", "give one of count, positions, cone, or inlet with rate");
  if (has_cone) inlet.cone = read_cone(t.table("cone"));
  read_flow(t, inlet);
  read_velocity(t, scene, inlet);
  if (!positions.empty() && scene.sizes)
    t.fail("diameter", "a distribution is for random particles and inlets: give each position its diameter");
  if (!positions.empty()) {
    scene.source = PlacedParticles{folder / positions};
  } else if (inlet.cone || !inlet.patch.empty()) {
    scene.source = inlet;
  } else {
    scene.source = RandomParticles{static_cast<std::size_t>(count)};
  }
  t.finish();
  return scene;
}

}  // namespace dartcast
