// Reads Gmsh's .msh section by section; gmsh_2.cpp and gmsh_4.cpp read those that differ between versions, and
// gmsh_periodic.cpp the last one.
#include "formats/gmsh.hpp"

#include <fmt/format.h>

#include <cstring>
#include <string>

#include "dartcast/error.hpp"
#include "formats/gmsh_parts.hpp"

namespace dartcast {
namespace {

using gmsh::Model;
using gmsh::NumberReader;

enum class Version { v1, v2, v40, v41 };

/// The head of versions 2 and 4.
Version read_format(NumberReader& in, Model& model) {
  FileText& text = in.text;
  const std::string number(text.word("the version"));
  const std::int64_t binary = text.integer("the file type", 0, 1);
  const bool v41 = number == "4.1";
  const std::int64_t size = text.integer("the size of a number", 4, 8);
  if (size != 8 && (size != 4 || !v41)) text.fail(fmt::format("numbers of {} bytes are not supported", size));
  in.short_sizes = size == 4;
  in.binary = binary == 1;
  if (in.binary) {
    text.line();
    std::int32_t one = 0;
    std::memcpy(&one, text.raw(4, "the byte order").data(), 4);
    if (one != 1 && one != 0x01000000) text.fail("the mark of the byte order is neither 1 nor its mirror");
    in.swapped = one != 1;
  }
  model.parsed.format = fmt::format("Gmsh {} {}", number.substr(0, 8), in.binary ? "binary" : "ASCII");
  if (number == "2" || number == "2.0" || number == "2.1" || number == "2.2") return Version::v2;
  if (number == "4" || number == "4.0") return Version::v40;
  if (v41) return Version::v41;
  text.fail(fmt::format("Gmsh version {} is not supported; use 1, 2.0 to 2.2, 4.0 or 4.1", number.substr(0, 8)));
}

void read_names(FileText& text, Model& model) {
  const std::size_t n = text.count("physical names", 5);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t dimension = text.integer("a dimension", 0, 3);
    const auto tag = static_cast<std::int32_t>(text.integer("a physical group", INT32_MIN, INT32_MAX));
    std::string_view name = text.line();
    const std::size_t open = name.find('"');
    const std::size_t close = name.rfind('"');
    if (open == std::string_view::npos || close == open) text.fail("a physical name is not in quotes");
    name = name.substr(open + 1, close - open - 1);
    if (dimension == 3) model.parsed.mesh.region_names[tag] = name;
    if (dimension == 2) model.parsed.mesh.patch_names[tag] = name;
    if (dimension == 1) model.parsed.edge_names[tag] = name;
  }
}

void read_nodes(NumberReader& in, Model& model, Version version, bool parametric) {
  if (model.nodes.closed()) in.text.fail("a second section of nodes");
  if (version == Version::v1 || version == Version::v2) {
    read_nodes_2(in, model, parametric);
  } else {
    read_nodes_4(in, model, version == Version::v41);
  }
  model.nodes.close();
}

void read_elements(NumberReader& in, Model& model, Version version) {
  if (!model.nodes.closed()) in.text.fail("elements stand before the nodes");
  if (version == Version::v1) {
    read_elements_1(in, model);
  } else if (version == Version::v2) {
    read_elements_2(in, model);
  } else {
    model.repeats_elements = false;
    read_elements_4(in, model, version == Version::v41);
  }
}

/// Reads the section `name`; false if this library does not use it: then the caller skips it.
bool read_section(std::string_view name, NumberReader& in, Model& model, Version& version) {
  if (name == "NOD" || name == "ELM") {
    version = Version::v1;
    model.parsed.format = "Gmsh 1 ASCII";
  }
  if (name == "MeshFormat") {
    version = read_format(in, model);
  } else if (name == "PhysicalNames") {
    read_names(in.text, model);
  } else if ((name == "Entities" || name == "PartitionedEntities") &&
             (version == Version::v40 || version == Version::v41)) {
    read_entities_4(in, model, version == Version::v41, name == "PartitionedEntities");
  } else if (name == "Nodes" || name == "NOD" || name == "ParametricNodes") {
    read_nodes(in, model, version, name == "ParametricNodes");
  } else if (name == "Elements" || name == "ELM") {
    read_elements(in, model, version);
  } else if (name == "Periodic" && model.nodes.closed() && !(version == Version::v40 && in.binary)) {
    read_periodic(in, model, version == Version::v41);
  } else {
    return false;
  }
  return true;
}

/// Names the other formats that end in .msh.
void refuse_other_msh(std::string_view content) {
  const std::string_view text = from_first_word(content);
  if (text.starts_with("("))
    throw InvalidMesh("this .msh is of ANSYS Fluent, which is not supported; convert it to Gmsh's");
  if (text.starts_with("$")) return;
  if (text.starts_with("MeshVersionFormatted")) throw InvalidMesh("this .msh is of Medit; rename it to .mesh");
  throw InvalidMesh("this .msh is not of Gmsh: it does not start with '$'");
}

}  // namespace

ParsedMesh parse_gmsh(std::string_view content, bool linearise) {
  refuse_other_msh(content);
  FileText text(content);
  NumberReader in(text);
  Model model;
  model.parsed.linearise = linearise;
  Version version = Version::v2;
  bool elements = false;
  while (!text.at_end()) {
    std::string_view name = text.line();
    while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
    if (name.size() < 2 || name[0] != '$') text.fail("a section that starts with '$' should stand before this line");
    name.remove_prefix(1);
    const std::string end = fmt::format("${}{}", name == "NOD" || name == "ELM" ? "END" : "End", name);
    if (read_section(name, in, model, version)) {
      if (text.word(end) != end) text.fail(fmt::format("'{}' should stand here", end));
    } else {
      text.skip_past(end);
    }
    elements = elements || name == "Elements" || name == "ELM";
  }
  if (!elements) throw InvalidMesh("the file has no elements; it is truncated, or not a mesh");
  if (model.parsed.mesh.types.empty() && model.parsed.mesh.patch_tags.empty() &&
      model.parsed.second_order.count + model.parsed.unsupported.count == 0) {
    throw InvalidMesh("the file has points or lines only; write its cells too");
  }
  add_finding(model.parsed.warnings, model.repeated);
  add_finding(model.parsed.warnings, model.unknown);
  add_periodic_pairs(model);
  finish(model.parsed);
  return std::move(model.parsed);
}

}  // namespace dartcast
