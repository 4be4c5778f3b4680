// Builds a cell complex, and swaps its positions.
#include "dartcast/cell_complex.hpp"

#include <memory>
#include <utility>

#include "complex/periodic_faces.hpp"
#include "complex/steiner_points.hpp"
#include "dartcast/validity.hpp"

namespace dartcast {

CellComplex::CellComplex(const MeshData& mesh, Threads threads)
    : map_(mesh), point_count_(mesh.points.size()), front_(mesh.points.begin(), mesh.points.end()) {
  constexpr std::size_t all = static_cast<std::size_t>(-1);
  invalid_ = check_validity(map_, front_, threads, all).first;
  if (!invalid_.empty()) {
    std::vector<Cell> bad;
    for (const InvalidCell& cell : invalid_) bad.push_back(cell.cell);
    SteinerSolution solution = find_steiner_points(mesh, map_, bad);
    steiner_ = std::move(solution.weights);
    map_ = CombinatorialMap(mesh, solution.points);
    front_.resize(mesh.points.size() + steiner_.count());
    steiner_.compute(front_);
    invalid_ = check_validity(map_, front_, threads, all).first;
  }
  for (const Cell c : map_.cells()) simplex_count_ += map_.shape(c).simplices().size();
  if (!mesh.periodic.empty())
    periodic_ = std::make_shared<const detail::PeriodicFaces>(mesh.periodic, map_, positions());
}

std::span<Vec3> CellComplex::next_positions() {
  if (back_.empty()) back_ = front_;
  return std::span<Vec3>(back_).first(point_count());
}

void CellComplex::commit_positions() {
  if (back_.empty()) back_ = front_;
  steiner_.compute(back_);
  std::swap(front_, back_);
}

CellComplex CellComplex::before_move() const {
  CellComplex before = *this;
  if (!back_.empty()) before.front_ = back_;
  return before;
}

std::size_t CellComplex::bytes() const { return map_.bytes() + steiner_.bytes() + front_.size() * sizeof(Vec3); }

}  // namespace dartcast
