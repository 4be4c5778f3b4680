// Versions 1 and 2 of Gmsh's format.
#include <fmt/format.h>

#include "formats/gmsh_parts.hpp"

namespace dartcast::gmsh {
namespace {

/// Node numbers are signed in the file; a negative one names no node.
std::uint64_t node_number(NumberReader& in) { return static_cast<std::uint64_t>(in.int32("a node number")); }

// An element of first or second order has it.
int dimension_of(int type) {
  if (type == 1 || type == 8) return 1;
  return type == 2 || type == 3 || type == 9 || type == 10 || type == 16 ? 2 : 3;
}

}  // namespace

void read_nodes_2(NumberReader& in, Model& model, bool parametric) {
  const std::size_t n = in.text.count("nodes", in.binary ? 28 : 8);
  if (in.binary) in.text.line();
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t number = node_number(in);
    Vec3 p;
    p.x = in.real("a coordinate");
    p.y = in.real("a coordinate");
    p.z = in.real("a coordinate");
    model.nodes.add(number, p, model.parsed.mesh);
    if (!parametric) continue;
    const std::int32_t dimension = in.int32("the dimension of an entity");
    in.int32("an entity");
    for (int k = 0; k < dimension && dimension < 3; ++k) in.real("a parameter");
  }
}

void read_elements_1(NumberReader& in, Model& model) {
  const std::size_t n = in.text.count("elements", 10);
  std::vector<std::uint64_t> nodes;
  for (std::size_t i = 0; i < n; ++i) {
    in.int32("an element number");
    const int type = in.int32("an element type");
    const std::int32_t physical = in.int32("a physical group");
    in.int32("an elementary group");
    const int count = in.int32("a number of nodes");
    if (count != known_node_count(in, type))
      in.text.fail(fmt::format("element type {} does not have {} nodes", type, count));
    nodes.clear();
    for (int k = 0; k < count; ++k) nodes.push_back(node_number(in));
    model.add_element(type, nodes, physical);
  }
}

void read_elements_2(NumberReader& in, Model& model) {
  const std::size_t n = in.text.count("elements", in.binary ? 8 : 6);
  if (in.binary) in.text.line();
  std::vector<std::uint64_t> nodes;
  for (std::size_t done = 0; done < n;) {
    if (!in.binary) in.int32("an element number");
    const int type = in.int32("an element type");
    const std::int32_t in_block = in.binary ? in.int32("a number of elements") : 1;
    const std::int32_t tags = in.int32("a number of tags");
    const int count = known_node_count(in, type);
    if (in_block < 1 || static_cast<std::size_t>(in_block) > n - done) in.text.fail("a block of elements is too long");
    if (tags < 0) in.text.fail("a number of tags is negative");
    in.text.check_count("tags", static_cast<std::uint64_t>(tags), in.binary ? 4 : 2);
    for (std::int32_t i = 0; i < in_block; ++i, ++done) {
      if (in.binary) in.int32("an element number");
      std::int32_t physical = 0;
      for (std::int32_t t = 0; t < tags; ++t) {
        const std::int32_t tag = in.int32("a tag");
        if (t == 0) physical = tag;
        if (t == 1) model.physical.emplace(std::pair{dimension_of(type), tag}, physical);
      }
      nodes.clear();
      for (int k = 0; k < count; ++k) nodes.push_back(node_number(in));
      model.add_element(type, nodes, physical);
    }
  }
}

}  // namespace dartcast::gmsh
