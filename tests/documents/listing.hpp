// A place for the statements of docs/guide.md, with the names that the page speaks of.
#pragma once

#include <cstdio>
#include <span>

#include "dartcast/dartcast.hpp"

#pragma GCC diagnostic ignored "-Wshadow"  // a listing may give a name of its place another meaning

using namespace dartcast;

namespace {

struct Listing {
  [[maybe_unused]] void run();

  const MeshData& mesh;
  std::span<const Vec3> points;
  std::span<const Vec3> targets;
};

}  // namespace
