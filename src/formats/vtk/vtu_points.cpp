// Decodes the points of a .vtu file, and hashes its cells.
#include "formats/vtk/vtu_points.hpp"

#include <utility>

#include "formats/vtk/vtk_xml.hpp"
#include "formats/vtk/vtu_check.hpp"

namespace dartcast {
namespace {

// Multiplications mix low bits into high ones, shifts bring them back (as in MurmurHash3, A. Appleby).
std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0xff51afd7ed558ccdU;
  return hash ^ (hash >> 32U);
}

std::uint64_t hash_of(const VtuArray& array, const VtuEncoding& encoding) {
  const std::vector<std::int64_t> values = decode_integers(array, encoding);
  std::uint64_t hash = values.size();
  for (const char c : array.name) hash = mixed(hash, static_cast<unsigned char>(c));
  for (const std::int64_t value : values) hash = mixed(hash, static_cast<std::uint64_t>(value));
  return hash;
}

}  // namespace

std::optional<VtuPoints> read_vtu_points(std::string_view content, std::uint64_t max_memory) {
  constexpr std::string_view kind = "UnstructuredGrid";
  check_vtu(content, kind, max_memory);
  const VtkXmlFile file = read_vtk_xml(content, kind);
  if (file.pieces.size() != 1) return std::nullopt;
  const VtkXmlPiece& piece = file.pieces.front();
  const auto reals = decode_reals(piece.arrays("Points").front(), file.encoding);
  if (!reals) return std::nullopt;
  VtuPoints result{{}, piece.cells()};
  result.points.resize(reals->size() / 3);
  for (std::size_t i = 0; i < result.points.size(); ++i)
    result.points[i] = {(*reals)[3 * i], (*reals)[3 * i + 1], (*reals)[3 * i + 2]};
  for (const VtuArray& array : piece.arrays("Cells")) {
    if (array.type != "Float32" && array.type != "Float64")
      result.cells = mixed(result.cells, hash_of(array, file.encoding));
  }
  return result;
}

}  // namespace dartcast
