// The parts that all versions of Gmsh's format share.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/file_text.hpp"
#include "formats/parsed_mesh.hpp"
#include "mesh/periodic_pairs.hpp"

namespace dartcast::gmsh {

/// Numbers in text or in binary of either byte order.
class NumberReader {
 public:
  explicit NumberReader(FileText& source) : text(source) {}

  FileText& text;
  bool binary = false;
  bool swapped = false;
  bool short_sizes = false;  ///< version 4.1 with a data size of 4: sizes have 32 bits instead of 64

  std::int32_t int32(std::string_view what);
  /// An unsigned number of the size of the file's size_t.
  std::uint64_t size(std::string_view what);
  double real(std::string_view what);
  /// The same, for a number of items of at least so many bytes each.
  std::size_t count(std::string_view what, std::size_t text_bytes, std::size_t binary_bytes);

 private:
  template <class T>
  T raw(std::string_view what);
};

/// From node numbers in the file to points.
class NodeTable {
 public:
  void add(std::uint64_t number, const Vec3& point, MeshData& mesh);
  /// To be called once after all nodes. Throws InvalidMesh if a number occurs twice.
  void close();
  [[nodiscard]] bool closed() const { return closed_; }
  /// The point's index, or no_point.
  [[nodiscard]] std::uint32_t find(std::uint64_t number) const;

 private:
  std::vector<std::pair<std::uint64_t, std::uint32_t>> numbers_;
  std::vector<std::uint32_t> dense_;
  bool closed_ = false;
};

/// Number of nodes of an element type of any order; 0 for an unknown type, and for one without a fixed number.
int node_count(int type);
/// The same. Throws InvalidMesh with the line if it is 0.
int known_node_count(const NumberReader& in, int type);

/// The result that the sections fill.
struct Model {
  ParsedMesh parsed;
  NodeTable nodes;
  std::size_t elements = 0;
  bool repeats_elements = true;                                   ///< versions 1 and 2
  std::map<std::pair<int, std::int32_t>, std::int32_t> physical;  ///< (dimension, entity) to physical group

  struct Periodic {
    int dimension = 0;
    std::int32_t entity = 0;
    std::int32_t master = 0;
    std::vector<PartnerPlaces> places;  ///< of the master's nodes, and of the entity's
  };
  std::vector<Periodic> periodic;

  /// Adds an element of a known type whose nodes are given by number. Versions 1 and 2 have an element once for each of
  /// its groups, one after the other: only the first counts.
  void add_element(int type, std::span<const std::uint64_t> numbers, std::int32_t physical_tag);

  Finding unknown{
      "unknown_entities", 0, {}, "elements of entities that the file does not describe; they are in no group"};
  Finding repeated{
      "several_groups", 0, {}, "elements that the file has again for another group; the first group counts"};

 private:
  int last_type_ = 0;
  std::int32_t last_group_ = 0;
  std::vector<std::uint64_t> last_;  // the nodes of the element before
};

/// The sections of version 4.0 and 4.1; each leaves the reader before its end mark.
void read_entities_4(NumberReader& in, Model& model, bool v41, bool of_parts);
void read_nodes_4(NumberReader& in, Model& model, bool v41);
void read_elements_4(NumberReader& in, Model& model, bool v41);

/// The sections of version 1 and 2.
void read_nodes_2(NumberReader& in, Model& model, bool parametric);
void read_elements_1(NumberReader& in, Model& model);
void read_elements_2(NumberReader& in, Model& model);

/// The section behind the elements.
void read_periodic(NumberReader& in, Model& model, bool v41);
/// Adds the pairs of patches whose entities are periodic. A warning counts patches that no one motion takes to another.
void add_periodic_pairs(Model& model);

}  // namespace dartcast::gmsh
