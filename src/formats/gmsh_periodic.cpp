// Gmsh's periodic entities: each has the nodes of a master entity, moved. Those of two patches are a periodic pair.
#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/gmsh_parts.hpp"

namespace dartcast::gmsh {
namespace {

// The matrix is not needed: the nodes show the motion.
void skip_matrix(NumberReader& in, bool v41) {
  if (!v41) {
    if (in.text.peek() == "Affine") in.text.line();
    return;
  }
  const std::size_t numbers = in.count("numbers of a matrix", 2, 8);
  for (std::size_t i = 0; i < numbers; ++i) in.real("a number of a matrix");
}

std::string name_of(const Model& model, int dimension, std::int32_t group) {
  const auto& names = dimension == 2 ? model.parsed.mesh.patch_names : model.parsed.edge_names;
  const auto name = names.find(group);
  return name == names.end() ? fmt::format("{}", group) : name->second;
}

// 0: none.
std::int32_t group_of(const Model& model, int dimension, std::int32_t entity) {
  const auto group = model.physical.find({dimension, entity});
  return group == model.physical.end() ? 0 : group->second;
}

std::set<std::int32_t> entities_of(const Model& model, int dimension, std::int32_t group) {
  std::set<std::int32_t> entities;
  for (const auto& [entity, of] : model.physical) {
    if (entity.first == dimension && of == group) entities.insert(entity.second);
  }
  return entities;
}

}  // namespace

void read_periodic(NumberReader& in, Model& model, bool v41) {
  in.binary = in.binary && v41;  // text in binary files of version 2, too
  const auto number = [&](std::string_view what) {
    return v41 ? in.size(what) : static_cast<std::uint64_t>(in.int32(what));
  };
  const std::size_t entities = in.count("periodic entities", 8, 28);
  for (std::size_t i = 0; i < entities; ++i) {
    Model::Periodic entity;
    entity.dimension = in.int32("the dimension of an entity");
    entity.entity = in.int32("an entity");
    entity.master = in.int32("a master entity");
    skip_matrix(in, v41);
    const std::size_t nodes = in.count("periodic nodes", 4, 8);
    for (std::size_t n = 0; n < nodes; ++n) {
      const std::uint32_t to = model.nodes.find(number("a node number"));
      const std::uint32_t from = model.nodes.find(number("a node number"));
      if (to == no_point || from == no_point) in.text.fail("a periodic node is none of the file's");
      entity.places.push_back({model.parsed.mesh.points[from], model.parsed.mesh.points[to]});
    }
    model.periodic.push_back(std::move(entity));
  }
}

void add_periodic_pairs(Model& model) {
  const int dimension = model.parsed.mesh.types.empty() ? 1 : 2;
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<PartnerPlaces>> places;
  std::map<std::int32_t, std::set<std::int32_t>> entities;  // by group
  for (const Model::Periodic& entity : model.periodic) {
    if (entity.dimension != dimension) continue;
    const std::pair groups = {group_of(model, dimension, entity.master), group_of(model, dimension, entity.entity)};
    if (groups.first == 0 || groups.second == 0 || groups.first == groups.second) continue;
    entities[groups.first].insert(entity.master);
    entities[groups.second].insert(entity.entity);
    places[groups].insert(places[groups].end(), entity.places.begin(), entity.places.end());
  }
  Finding unfitted{
      "cyclic", 0, {}, "periodic groups that no one motion takes to one other group as a whole: they are no pairs"};
  std::set<std::int32_t> paired;
  for (const auto& [groups, nodes] : places) {
    auto pair = fitted_pair(nodes);
    const bool whole = entities[groups.first] == entities_of(model, dimension, groups.first) &&
                       entities[groups.second] == entities_of(model, dimension, groups.second);
    if (!pair || !whole || !paired.insert(groups.first).second || !paired.insert(groups.second).second) {
      unfitted.add(static_cast<std::size_t>(groups.first));
      continue;
    }
    pair->a = name_of(model, dimension, groups.first);
    pair->b = name_of(model, dimension, groups.second);
    model.parsed.mesh.periodic.push_back(std::move(*pair));
  }
  add_finding(model.parsed.warnings, unfitted);
}

}  // namespace dartcast::gmsh
