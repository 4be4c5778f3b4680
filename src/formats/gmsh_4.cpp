// Versions 4.0 and 4.1 of Gmsh's format.
#include <fmt/format.h>

#include <cstdlib>

#include "formats/gmsh_parts.hpp"

namespace dartcast::gmsh {
namespace {

int checked_dimension(NumberReader& in, std::int32_t dimension) {
  if (dimension < 0 || dimension > 3) in.text.fail(fmt::format("{} is not the dimension of an entity", dimension));
  return dimension;
}

/// Head of a block of nodes or elements.
struct Block {
  int dimension = 0;
  std::int32_t entity = 0;
  std::int32_t extra = 0;  // parametric, or the elements' type
  std::size_t size = 0;
};

Block read_block(NumberReader& in, bool v41, std::string_view what, std::size_t text_bytes, std::size_t binary_bytes) {
  Block block;
  const std::int32_t first = in.int32("an entity");
  const std::int32_t second = in.int32("an entity");
  block.dimension = checked_dimension(in, v41 ? first : second);
  block.entity = v41 ? second : first;
  block.extra = in.int32("a block's type");
  block.size = in.count(what, text_bytes, binary_bytes);
  return block;
}

std::size_t read_block_count(NumberReader& in, bool v41) {
  const std::size_t blocks = in.count("blocks", 8, 16);
  in.size("a total");
  if (v41) {
    in.size("a smallest number");
    in.size("a largest number");
  }
  return blocks;
}

/// The entity that one of a partition lies in. It has the same groups, unless it has some of its own. Returns whether it is
/// of the same dimension; others lie between two partitions.
bool read_parent(NumberReader& in, Model& model, int dimension, std::int32_t tag) {
  const std::int32_t of = in.int32("the dimension of a parent");
  const std::int32_t parent = in.int32("a parent");
  const auto group = model.physical.find({of, parent});
  if (of == dimension && group != model.physical.end()) model.physical[{dimension, tag}] = group->second;
  const std::size_t parts = in.count("partitions", 2, 4);
  for (std::size_t k = 0; k < parts; ++k) in.int32("a partition");
  return of == dimension;
}

}  // namespace

void read_entities_4(NumberReader& in, Model& model, bool v41, bool of_parts) {
  if (of_parts) {
    in.size("the number of partitions");
    const std::size_t ghosts = in.count("ghost entities", 4, 8);
    for (std::size_t i = 0; i < 2 * ghosts; ++i) in.int32("a ghost entity, or its partition");
  }
  std::size_t counts[4];
  for (std::size_t& n : counts) n = in.count("entities", 8, 32);
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::size_t i = 0; i < counts[dimension]; ++i) {
      const std::int32_t tag = in.int32("an entity");
      model.physical[{dimension, tag}] = 0;
      const bool in_groups = !of_parts || read_parent(in, model, dimension, tag);
      const int bounds = v41 && dimension == 0 ? 3 : 6;
      for (int k = 0; k < bounds; ++k) in.real("a bound");
      const std::size_t groups = in.count("physical groups", 2, 4);
      for (std::size_t k = 0; k < groups; ++k) {
        const std::int32_t group = in.int32("a physical group");
        // The sign is the orientation of the entity in its group.
        if (k == 0 && in_groups) model.physical[{dimension, tag}] = group < 0 && group != INT32_MIN ? -group : group;
      }
      if (dimension == 0) continue;
      const std::size_t boundary = in.count("bounding entities", 2, 4);
      for (std::size_t k = 0; k < boundary; ++k) in.int32("a bounding entity");
    }
  }
}

void read_nodes_4(NumberReader& in, Model& model, bool v41) {
  const std::size_t blocks = read_block_count(in, v41);
  std::vector<std::uint64_t> numbers;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block block = read_block(in, v41, "nodes", 8, 28);
    const int parameters = block.extra != 0 ? block.dimension : 0;
    const auto read_number = [&] {
      return v41 ? in.size("a node number") : static_cast<std::uint64_t>(in.int32("a node number"));
    };
    numbers.clear();
    for (std::size_t i = 0; v41 && i < block.size; ++i) numbers.push_back(read_number());
    for (std::size_t i = 0; i < block.size; ++i) {
      const std::uint64_t number = v41 ? numbers[i] : read_number();
      Vec3 p;
      p.x = in.real("a coordinate");
      p.y = in.real("a coordinate");
      p.z = in.real("a coordinate");
      for (int k = 0; k < parameters; ++k) in.real("a parameter");
      model.nodes.add(number, p, model.parsed.mesh);
    }
  }
}

void read_elements_4(NumberReader& in, Model& model, bool v41) {
  const std::size_t blocks = read_block_count(in, v41);
  std::vector<std::uint64_t> nodes;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block block = read_block(in, v41, "elements", 4, 8);
    const int count = known_node_count(in, block.extra);
    const auto group = model.physical.find({block.dimension, block.entity});
    const bool known = group != model.physical.end();
    const std::int32_t physical = known ? group->second : 0;
    const auto read_number = [&] {
      return v41 ? in.size("a node number") : static_cast<std::uint64_t>(in.int32("a node number"));
    };
    for (std::size_t i = 0; i < block.size; ++i) {
      if (!known && !model.physical.empty()) model.unknown.add(model.elements);
      read_number();
      nodes.clear();
      for (int k = 0; k < count; ++k) nodes.push_back(read_number());
      model.add_element(block.extra, nodes, physical);
    }
  }
}

}  // namespace dartcast::gmsh
