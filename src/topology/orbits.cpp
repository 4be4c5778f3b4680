// Orbits: the darts that are reached from one by some of the phi.
#include <initializer_list>
#include <set>

#include "dartcast/map_edits.hpp"

namespace dartcast {

namespace {

// Closure of {d} under some relations. They include inverses, because a boundary breaks the cycles.
template <class... Relation>
std::vector<Dart> closure(Dart d, Relation... relation) {
  std::vector<Dart> orbit = {d};
  std::set<Dart> seen = {d};
  for (std::size_t i = 0; i < orbit.size(); ++i) {
    for (const Dart next : {relation(orbit[i])...}) {
      if (next.valid() && seen.insert(next).second) orbit.push_back(next);
    }
  }
  return orbit;
}

}  // namespace

std::vector<Dart> vertex_orbit(const CombinatorialMap& map, Dart d) {
  const auto phi21 = [&](Dart x) { return map.alpha1(x); };
  const auto phi_12 = [&](Dart x) { return map.phi2(map.phi_1(x)); };
  const auto phi31 = [&](Dart x) {
    const Dart other = map.phi3(x);
    return other.valid() ? map.phi1(other) : other;
  };
  const auto phi_13 = [&](Dart x) { return map.phi3(map.phi_1(x)); };
  return closure(d, phi21, phi_12, phi31, phi_13);
}

std::vector<Dart> edge_orbit(const CombinatorialMap& map, Dart d) {
  return closure(
      d, [&](Dart x) { return map.phi2(x); }, [&](Dart x) { return map.phi3(x); });
}

std::vector<Dart> face_orbit(const CombinatorialMap& map, Dart d) {
  return closure(
      d, [&](Dart x) { return map.phi1(x); }, [&](Dart x) { return map.phi3(x); });
}

std::vector<Dart> cell_orbit(const CombinatorialMap& map, Dart d) {
  if (map.dimension() == 2) return face_orbit(map, d);
  return closure(
      d, [&](Dart x) { return map.phi1(x); }, [&](Dart x) { return map.phi2(x); });
}

}  // namespace dartcast
