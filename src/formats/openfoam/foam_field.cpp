// Reads a field's file from its first entry to the last one that is wanted. Values of entries on the way are macros of later
// ones.
#include "formats/openfoam/foam_field.hpp"

#include <fmt/format.h>
#include <regex.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "formats/openfoam/foam_file.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

/// Moves to the value of an entry; false if there is none. Collects the values that stand before it, also in files that
/// this one includes. Other directives are passed over: their values are missed if they are needed.
bool find_entry(FoamFile& file, std::string_view wanted, const fs::path& folder, std::uint64_t max_memory,
                FoamMacros& values, unsigned depth = 0) {
  constexpr unsigned deepest = 10;
  while (file.next() != '\0') {
    if (file.next() == '#') {
      const std::string name = file.directive();
      if (name.empty() || depth == deepest || !has_foam_file(folder, name)) continue;
      FoamFile included(folder, name, max_memory, true);
      find_entry(included, wanted, (folder / name).parent_path(), max_memory, values, depth + 1);
    } else if (file.next() == '$') {
      file.skip_entry();
    } else {
      const std::string key(file.word("a key"));
      if (key == wanted && depth == 0) return true;
      values[key] = file.entry();
    }
  }
  return false;
}

/// One value for all items, or one for each.
struct ItemValues {
  bool uniform = false;
  std::vector<double> values;
};

ItemValues read_values(FoamFile& file, std::string_view key, std::size_t components, const FoamMacros& macros) {
  file.expand(macros);
  const std::string kind(file.word("'uniform' or 'nonuniform'"));
  if (kind == "nonuniform") return {false, file.numbers("values", components)};
  if (kind != "uniform") file.fail(fmt::format("{} {}: it must be uniform or nonuniform", key, kind));
  ItemValues one{true, {}};
  file.expand(macros);
  if (components > 1) file.expect('(', "before the value of all");
  for (std::size_t k = 0; k < components; ++k) {
    file.expand(macros);
    one.values.push_back(file.number("a number"));
  }
  if (components > 1) file.expect(')', "behind the value of all");
  return one;
}

// Appends the values of so many items.
void append_to(std::vector<double>& to, const ItemValues& from, std::size_t items) {
  for (std::size_t i = 0; i < (from.uniform ? items : 1); ++i)
    to.insert(to.end(), from.values.begin(), from.values.end());
}

/// An entry of boundaryField.
struct PatchEntryValues {
  std::string name;
  std::string type;
  ItemValues value;  ///< none: no values
};

std::size_t components_of_list(std::string_view type) {
  if (type == "List<vector>") return 3;
  if (type == "List<symmTensor>") return 6;
  return type == "List<tensor>" ? 9 : 1;
}

// Lists of binary files have any bytes, also braces: they are read to be skipped.
void skip_patch_entry(FoamFile& file) {
  if (file.next() == 'n' && file.word("a value") == "nonuniform" && file.next() == 'L') {
    const std::size_t components = components_of_list(file.word("the type of a list"));
    file.numbers("values", components);
  }
  file.skip_entry();
}

bool has_no_values(std::string_view type) {
  return type == "zeroGradient" || type == "empty" || type == "wedge" || type.starts_with("cyclic") ||
         type.starts_with("processor");
}

PatchEntryValues read_patch_entry(FoamFile& file, std::size_t components, const FoamMacros& macros) {
  PatchEntryValues entry;
  entry.name = file.word("the name of a patch");
  file.expect('{', fmt::format("behind the name {}", entry.name));
  while (!file.take('}')) {
    if (file.next() == '#') {
      file.directive();
      continue;
    }
    const bool macro = file.next() == '$';
    const std::string key(macro ? std::string_view() : file.word("a key of a patch"));
    if (key == "type") entry.type = file.word("the type of a patch");
    if (key == "value" && file.next() != '$') entry.value = read_values(file, key, components, macros);
    skip_patch_entry(file);
  }
  if (entry.type == "noSlip") entry.value = {true, std::vector<double>(components, 0.0)};
  if (has_no_values(entry.type)) entry.value = {};
  return entry;
}

// By POSIX: without back references it takes a time in proportion to the name, and memory in proportion to the product
// of counts in braces. A long name or a hostile pattern overflows the stack of std::regex, or takes it for ever.
bool matches(const std::string& pattern, const std::string& name) {
  const auto refers_back = [&](std::size_t i) {
    return pattern[i] == '\\' && std::isdigit(static_cast<unsigned char>(pattern[i + 1])) != 0;
  };
  if (pattern.size() > 255 || pattern.find('{') != std::string::npos) return false;
  for (std::size_t i = 0; i < pattern.size(); ++i)
    if (refers_back(i)) return false;
  regex_t compiled;
  if (regcomp(&compiled, ("^(" + pattern + ")$").c_str(), REG_EXTENDED | REG_NOSUB) != 0) return false;
  const bool found = regexec(&compiled, name.c_str(), 0, nullptr, 0) == 0;
  regfree(&compiled);
  return found;
}

// By name; else by the last pattern that matches.
const PatchEntryValues* entry_of(const std::vector<PatchEntryValues>& entries, const std::string& patch) {
  const auto named = std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.name == patch; });
  if (named != entries.end()) return &*named;
  const auto last =
      std::find_if(entries.rbegin(), entries.rend(), [&](const auto& e) { return matches(e.name, patch); });
  return last != entries.rend() ? &*last : nullptr;
}

FoamFaceValues read_boundary_field(FoamFile& file, std::size_t components, std::span<const PolyPatchRange> patches,
                                   const FoamMacros& macros) {
  std::vector<PatchEntryValues> entries;
  file.expect('{', "behind boundaryField");
  while (!file.take('}')) {
    if (file.next() == '#') {
      file.directive();
    } else if (file.next() == '$') {
      file.skip_entry();
    } else {
      entries.push_back(read_patch_entry(file, components, macros));
    }
  }
  FoamFaceValues out;
  for (const PolyPatchRange& patch : patches) {
    const PatchEntryValues* const entry = entry_of(entries, patch.patch.name);
    if (entry == nullptr || patch.size == 0 || (entry->value.values.empty() && !entry->value.uniform)) continue;
    append_to(out.values, entry->value, patch.size);
    for (std::size_t f = 0; f < patch.size; ++f) out.faces.push_back(static_cast<std::uint32_t>(patch.first + f));
    if (out.values.size() != out.faces.size() * components)
      file.fail(fmt::format("{} values for the {} faces of the patch {}", entry->value.values.size() / components,
                            patch.size, patch.patch.name));
  }
  return out;
}

}  // namespace

FoamFieldValues read_foam_field(const fs::path& folder, std::string_view name, std::size_t components,
                                std::size_t items, std::span<const PolyPatchRange> patches, std::uint64_t max_memory) {
  FoamFile file(folder, name, max_memory);
  FoamMacros macros;
  if (!find_entry(file, "internalField", folder, max_memory, macros)) file.fail("there is no internalField");
  FoamFieldValues out;
  const ItemValues inside = read_values(file, "internalField", components, macros);
  append_to(out.inside, inside, items);
  if (out.inside.size() != components * items)
    file.fail(fmt::format("{} values for {} cells or points", out.inside.size() / components, items));
  if (patches.empty()) return out;
  file.skip_entry();
  if (find_entry(file, "boundaryField", folder, max_memory, macros))
    out.faces = read_boundary_field(file, components, patches, macros);
  return out;
}

}  // namespace dartcast
