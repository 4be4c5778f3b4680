// Parts of a mesh by recursive bisection of the cells' middles.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "dartcast/error.hpp"
#include "mesh/cell_types.hpp"
#include "parts/mesh_part.hpp"

namespace dartcast {

namespace {

// The mean of the corners of all faces: any point in the cell does.
std::vector<Vec3> middles_of(const MeshData& mesh) {
  std::vector<Vec3> middles(mesh.cell_count());
  for (std::size_t c = 0; c < middles.size(); ++c) {
    Vec3 sum;
    double count = 0.0;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      for (const std::uint32_t p : face) {
        sum += mesh.points[p];
        count += 1.0;
      }
    });
    middles[c] = sum * (1.0 / count);
  }
  return middles;
}

class Bisection {
 public:
  Bisection(const std::vector<Vec3>& middles, std::span<const double> weights)
      : middles_(middles), weights_(weights), parts_(middles.size()) {}

  // Gives the cells the parts [first, first + count).
  void divide(std::span<std::uint32_t> cells, std::uint32_t first, std::uint32_t count) {
    if (count == 1) {
      for (const std::uint32_t c : cells) parts_[c] = first;
      return;
    }
    double Vec3::*const axis = longest_axis(cells);
    std::sort(cells.begin(), cells.end(), [&](std::uint32_t a, std::uint32_t b) {
      return middles_[a].*axis != middles_[b].*axis ? middles_[a].*axis < middles_[b].*axis : a < b;
    });
    const std::uint32_t low = count / 2;
    const std::size_t at = place_of(cells, low, count);
    divide(cells.first(at), first, low);
    divide(cells.subspan(at), first + low, count - low);
  }

  [[nodiscard]] std::vector<std::uint32_t>& parts() { return parts_; }

 private:
  [[nodiscard]] double weight(std::uint32_t c) const { return weights_.empty() ? 1.0 : weights_[c]; }

  [[nodiscard]] double Vec3::*longest_axis(std::span<const std::uint32_t> cells) const {
    Vec3 low = middles_[cells.front()];
    Vec3 high = low;
    for (const std::uint32_t c : cells) {
      const Vec3& m = middles_[c];
      low = {std::min(low.x, m.x), std::min(low.y, m.y), std::min(low.z, m.z)};
      high = {std::max(high.x, m.x), std::max(high.y, m.y), std::max(high.z, m.z)};
    }
    const Vec3 d = high - low;
    if (d.x >= d.y && d.x >= d.z) return &Vec3::x;
    return d.y >= d.z ? &Vec3::y : &Vec3::z;
  }

  // Where the first cells have low / count of the weight; each part gets a cell at least.
  [[nodiscard]] std::size_t place_of(std::span<const std::uint32_t> cells, std::uint32_t low,
                                     std::uint32_t count) const {
    double all = 0.0;
    for (const std::uint32_t c : cells) all += weight(c);
    const double wanted = all * low / count;
    double sum = 0.0;
    std::size_t at = 0;
    while (at < cells.size() && sum + 0.5 * weight(cells[at]) < wanted) sum += weight(cells[at++]);
    return std::clamp<std::size_t>(at, low, cells.size() - (count - low));
  }

  const std::vector<Vec3>& middles_;
  std::span<const double> weights_;
  std::vector<std::uint32_t> parts_;
};

}  // namespace

std::vector<std::uint32_t> bisected(const MeshData& mesh, std::uint32_t parts, std::span<const double> weights) {
  if (mesh.cell_count() < parts)
    throw InvalidArgument(
        fmt::format("partition: {} parts of {} cells: each part needs a cell", parts, mesh.cell_count()));
  const std::vector<Vec3> middles = middles_of(mesh);
  std::vector<std::uint32_t> cells(middles.size());
  std::iota(cells.begin(), cells.end(), 0U);
  Bisection bisection(middles, weights);
  bisection.divide(cells, 0, parts);
  return std::move(bisection.parts());
}

}  // namespace dartcast
