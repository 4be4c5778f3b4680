// Bounds of the memory that reading a file takes, and the limit of this machine.
#include "formats/read_memory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

constexpr std::uint64_t program_bytes = std::uint64_t{48} << 20U;
constexpr std::uint64_t max_bytes = std::uint64_t{1} << 63U;

/// A sum of products that stops at 2^63.
class ByteSum {
 public:
  ByteSum& add(std::uint64_t count, std::uint64_t each = 1) {
    const std::uint64_t left = max_bytes - sum_;
    sum_ = count > left / each ? max_bytes : sum_ + count * each;
    return *this;
  }
  [[nodiscard]] std::uint64_t bytes() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

std::uint64_t mesh_bytes(const ReadSizes& s) {
  return ByteSum().add(s.points, 32).add(s.corners, 10).add(s.cells, 32).add(s.values, 8).bytes();
}

/// Memory beyond the mesh for its check, or for building the map.
std::uint64_t use_bytes(const ReadSizes& s) {
  return std::max(ByteSum().add(s.corners, 32).add(s.points, 48).add(s.cells, 8).bytes(),
                  ByteSum().add(s.corners, 32).add(s.points, 24).add(s.cells, 24).bytes());
}

std::string shown_bytes(std::uint64_t bytes) {
  if (bytes >= max_bytes) return "more than any machine has";
  if (bytes >= 1000000000) return fmt::format("{:.2f} GB", static_cast<double>(bytes) * 1e-9);
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
}

std::uint64_t machine_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long size = ::sysconf(_SC_PAGE_SIZE);
  if (pages <= 0 || size <= 0) return max_bytes;
  return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size);
}

}  // namespace

std::uint64_t memory_of_vtk(const ReadSizes& s) {
  const std::uint64_t reading = ByteSum().add(s.decoded).add(s.corners, 18).add(s.cells, 20).bytes();
  return ByteSum().add(program_bytes).add(s.file).add(mesh_bytes(s)).add(std::max(reading, use_bytes(s))).bytes();
}

std::uint64_t memory_of_text(std::uint64_t file) { return ByteSum().add(program_bytes).add(file, 10).bytes(); }

std::uint64_t memory_of_mesh(const MeshData& mesh) {
  ReadSizes sizes;
  sizes.points = mesh.points.size();
  sizes.cells = mesh.cell_count();
  sizes.corners = mesh.connectivity.size() + mesh.patch_faces.size();
  for (const auto* arrays : {&mesh.point_data, &mesh.cell_data}) {
    for (const DataArray& array : *arrays) sizes.values += array.values.size();
  }
  return ByteSum().add(program_bytes).add(mesh_bytes(sizes)).add(use_bytes(sizes)).bytes();
}

std::uint64_t allowed_memory(std::uint64_t limit) { return limit > 0 ? limit : machine_bytes() / 2; }

void check_memory(std::uint64_t bytes, std::uint64_t limit) {
  const std::uint64_t allowed = allowed_memory(limit);
  if (bytes <= allowed) return;
  throw InvalidMesh(
      fmt::format("reading it may take {} of memory, but {} are allowed{}; check the sizes that the file announces, or "
                  "allow more with --max-memory (ReadOptions::max_memory)",
                  shown_bytes(bytes), shown_bytes(allowed), limit > 0 ? "" : ", half of this machine's memory"));
}

}  // namespace dartcast
