// A place for the statements of docs/guide.md, with the names that the page speaks of.
#pragma once

#include <cstdio>
#include <span>

#include "dartcast/dartcast.hpp"

// A listing may give a name of its place another meaning, and name what only the text after it speaks of.
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-variable"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#endif

using namespace dartcast;

namespace {

struct Listing {
  [[maybe_unused]] void run();

  const MeshData& mesh;
  std::span<const Vec3> points;
  std::span<const Vec3> targets;
};

}  // namespace
