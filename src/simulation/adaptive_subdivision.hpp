// Keeps cells small where particles crowd: subdivides full cells, and merges the parts again.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/events.hpp"
#include "simulation/cell_counts.hpp"

namespace dartcast {

/// Keeps the subdivisions that it has made.
class AdaptiveSubdivision {
 public:
  /// Throws InvalidArgument if min_particles >= max_particles, or smallest is negative or not finite.
  explicit AdaptiveSubdivision(const AdaptiveSubdivisionOptions& options);

  /// Makes an edit of the environment and takes its particles along: Simulation::edit(), or Environment::edit() and
  /// update_after_edit(). Returns what Environment::edit() returned.
  using Edit = std::function<ComplexEditReport(const std::function<void(ComplexEdit&)>& make)>;

  /// Subdivides cells that hold too many particles, then merges parts that hold few enough: each by an edit of its own.
  /// The report names cells that could not be subdivided or merged. `particles`: those that `edit` takes along. Throws
  /// what `edit` throws but EditRefused. `ranks`: that share the particles, and all make the same call; none: there is one
  /// process. Cost: for each edit linear in the particles, cells and subdivisions, and that of the edit.
  AdaptiveSubdivisionReport adapt(const CellComplex& complex, const Particles& particles, const Edit& edit,
                                  Ranks* ranks = nullptr);

  /// Repeats an edit, after all edits before it. Throws EditRefused, or InvalidArgument if there
  /// is no such cell or subdivision.
  void repeat(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit);

  /// To be called after other edits of the environment. Cost: that of dartcast::update_after_edit() for each
  /// subdivision there is.
  void update_after_edit(const CombinatorialMap& map, std::span<const Cell> added);

  /// The present subdivisions, each before those inside its parts.
  [[nodiscard]] std::span<const Subdivision> subdivisions() const { return subdivisions_; }

 private:
  struct Fullest {
    Cell cell;
    std::uint32_t particles = 0;
    std::uint64_t others = 0;  // above the threshold, too
  };

  [[nodiscard]] Fullest fullest(const CombinatorialMap& map) const;
  void subdivide_fullest(const CellComplex& complex, const Particles& particles, const Edit& edit,
                         AdaptiveSubdivisionReport& report);
  void merge_emptiest(const CellComplex& complex, const Particles& particles, const Edit& edit,
                      AdaptiveSubdivisionReport& report);
  [[nodiscard]] bool is_whole(const CombinatorialMap& map, std::size_t subdivision) const;
  void make(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit);
  bool try_edit(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit,
                SubdivisionRefusal refusal, AdaptiveSubdivisionReport& report);

  AdaptiveSubdivisionOptions options_;
  CellCounts counts_;
  Ranks* ranks_ = nullptr;  // in this call
  std::vector<Subdivision> subdivisions_;
  std::vector<Cell> passed_over_;  // in this call
};

}  // namespace dartcast
