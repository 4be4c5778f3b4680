// The file of one field: its values inside, and those that it gives faces of patches.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "formats/openfoam/poly_mesh.hpp"

namespace dartcast {

/// Faces of the boundary that have values in a field's file, by label, in the order of the patches.
struct FoamFaceValues {
  std::vector<std::uint32_t> faces;
  std::vector<double> values;
};

struct FoamFieldValues {
  std::vector<double> inside;
  FoamFaceValues faces;
};

/// Reads internalField, for so many items, and the values of these patches in boundaryField. The entry of a patch has
/// its name or, in quotes, a pattern that matches it. A patch has values if its entry has the key `value`, or is of the
/// type noSlip, which is 0. An entry has none if its type is zeroGradient, or leads to other cells (cyclic, processor,
/// empty, wedge), or if `value` is a macro without a plain value. Throws InvalidMesh with file and line or byte.
FoamFieldValues read_foam_field(const std::filesystem::path& folder, std::string_view name, std::size_t components,
                                std::size_t items, std::span<const PolyPatchRange> patches, std::uint64_t max_memory);

}  // namespace dartcast
