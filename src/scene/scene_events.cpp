// Reads the events of a scene.
#include <limits>

#include "dartcast/error.hpp"
#include "scene/scene_keys.hpp"

namespace dartcast {

namespace {

Vec3 vector(TomlTable& t, std::string_view key, std::string_view what) {
  Vec3 v;
  t.require(key, what);
  t.get(key, v);
  return v;
}

double length(TomlTable& t, std::string_view key, std::string_view what) {
  double value = 0.0;
  t.require(key, what);
  t.get(key, value, Range::positive);
  return value;
}

// If a constructor of a tool or an event refuses its arguments, the error names their place in the file.
template <class Make>
auto made(TomlTable& t, std::string_view key, Make&& make) {
  try {
    return make();
  } catch (const InvalidArgument& e) {
    t.fail(key, e.what());
  }
}

Plane plane(TomlTable& t) {
  const Vec3 point = vector(t, "point", "a point of the plane");
  const Vec3 normal = vector(t, "normal", "across the plane, of any length");
  return made(t, "normal", [&] { return plane_through(point, normal); });
}

Disc disc(TomlTable& t) {
  Disc d;
  d.centre = vector(t, "point", "the middle of the disc");
  d.normal = vector(t, "normal", "across the disc, of any length");
  d.radius = length(t, "radius", "of the disc");
  t.get("sides", d.sides, 3U, 1000U);
  return d;
}

BladePath blade(TomlTable& t) {
  BladePath path;
  t.require("places", "where the two ends of the blade are, one place after another: [{ a = [...], b = [...] }, ...]");
  for (TomlTable& place : t.tables("places")) {
    path.places.push_back({vector(place, "a", "one end of the blade"), vector(place, "b", "its other end")});
    place.finish();
  }
  return path;
}

Cut cut(TomlTable& t) {
  Cut c;
  using Surface = decltype(c.surface);
  Surface (*surface)(TomlTable&) = nullptr;
  t.require("surface", "plane, disc or blade");
  t.get("surface", surface,
        {{"plane", [](TomlTable& in) -> Surface { return plane(in); }},
         {"disc", [](TomlTable& in) -> Surface { return disc(in); }},
         {"blade", [](TomlTable& in) -> Surface { return blade(in); }}});
  c.surface = surface(t);
  c.width = length(t, "width", "of the layer that is opened");
  made(t, "surface", [&] { return std::visit([&](const auto& s) { return thicken(s, c.width); }, c.surface); });
  return c;
}

ConvexTool tool(TomlTable& t) {
  std::size_t kind = 0;
  t.require("tool", "box, capsule or ball");
  t.get("tool", kind, {"box", "capsule", "ball"});
  if (kind == 0) {
    const Vec3 low = vector(t, "low", "the lowest corner of the box");
    const Vec3 high = vector(t, "high", "its highest corner");
    return made(t, "high", [&] { return box_tool(low, high); });
  }
  const Vec3 a = vector(t, kind == 1 ? "a" : "point", kind == 1 ? "one end of the capsule" : "the middle of the ball");
  const Vec3 b = kind == 1 ? vector(t, "b", "its other end") : a;
  const double radius = length(t, "radius", "of the tool");
  return made(t, "radius", [&] { return capsule_tool(a, b, radius); });
}

Carve carve(TomlTable& t) {
  Carve c;
  c.tool = tool(t);
  t.get("what", c.what, {{"open", Carving::open}, {"remove", Carving::remove}});
  t.get("whole_cells", c.whole_cells);
  return c;
}

Ligature ligature(TomlTable& t) {
  Ligature l;
  l.plane = plane(t);
  t.get("point", l.place);
  t.get("place", l.place);
  t.get("draw", l.tying.share, {0.0, 0.999});
  if (l.tying.share > 0.0) {
    l.tying.reach = length(t, "reach", "how far from the ligature the walls are drawn along");
    l.duration = length(t, "duration", "seconds that the walls take");
  }
  return l;
}

Reconnect reconnect(TomlTable& t) {
  Reconnect r;
  for (const auto& [key, end] : {std::pair{"a", &r.a}, std::pair{"b", &r.b}}) {
    t.require(key, "an end: { point = [...], normal = [...] }");
    TomlTable table = t.table(key);
    *end = plane(table);
    table.finish();
  }
  r.within = length(t, "within", "the distance from these planes at which open faces belong to the ends");
  t.get("tolerance", r.options.tolerance, Range::not_negative);
  return r;
}

// A valve is cells, or walls without thickness.
void read_valve(TomlTable& t, EventScene& scene, bool opens) {
  using Valve = decltype(scene.event.what);
  const bool of_cells = t.get("region", scene.region);
  const bool of_walls = t.get("patch", scene.patch);
  if (of_cells == of_walls)
    t.fail("kind", "give either region = \"NAME\", whose cells open or close, or patch = \"NAME\"");
  if (of_cells)
    scene.event.what = opens ? Valve{OpenCells{}} : Valve{CloseCells{}};
  else
    scene.event.what = opens ? Valve{OpenWalls{}} : Valve{CloseWalls{}};
}

}  // namespace

EventScene read_event(TomlTable& t) {
  EventScene scene;
  t.require("at", "the time in seconds");
  t.get("at", scene.event.at, Range::not_negative);
  EventKind kind = EventKind::cut;
  t.require("kind", "cut, carve, ligature, reconnect, open or close");
  t.get("kind", kind,
        {{"cut", EventKind::cut},
         {"carve", EventKind::carve},
         {"ligature", EventKind::ligature},
         {"reconnect", EventKind::reconnect},
         {"open", EventKind::open},
         {"close", EventKind::close}});
  switch (kind) {
    case EventKind::cut: scene.event.what = cut(t); break;
    case EventKind::carve: scene.event.what = carve(t); break;
    case EventKind::ligature: scene.event.what = ligature(t); break;
    case EventKind::reconnect:
      scene.event.what = reconnect(t);
      t.get("patch", scene.patch);
      break;
    case EventKind::open:
    case EventKind::close: read_valve(t, scene, kind == EventKind::open); break;
  }
  t.get("stranded", scene.event.orphaned,
        {{"move", OrphanPolicy::relocate}, {"stay", OrphanPolicy::hold}, {"absorb", OrphanPolicy::absorb}});
  t.get("required", scene.event.required);
  t.finish();
  return scene;
}

}  // namespace dartcast
