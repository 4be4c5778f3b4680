// A mesh as the library sees it and as the oracle does, side by side; and the comparison of walks and steps.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "oracle/oracle.hpp"
#include "oracle/scenes.hpp"
#include "tracking/walk.hpp"

namespace dartcast::test {

class CheckedScene {
 public:
  explicit CheckedScene(MeshData mesh);

  /// Whether the library and the oracle find every simplex positive; nothing else may be asked where it is false.
  [[nodiscard]] bool valid() const { return oracle_ != nullptr && oracle_->all_positive(); }
  [[nodiscard]] const CellComplex& complex() const { return complex_; }
  [[nodiscard]] const MeshData& mesh() const { return mesh_; }
  [[nodiscard]] const oracle::Oracle& oracle() const { return *oracle_; }
  /// Free simplices, by their numbers in the oracle.
  [[nodiscard]] const std::vector<std::uint32_t>& free_simplices() const { return free_simplices_; }

  [[nodiscard]] std::uint32_t oracle_simplex(SimplexId s) const;
  [[nodiscard]] SimplexId library_simplex(std::uint32_t s) const { return library_[s]; }
  /// The oracle's wall triangle at a facet.
  [[nodiscard]] std::uint32_t oracle_wall(SimplexId s, unsigned facet) const;
  [[nodiscard]] std::uint32_t oracle_wall(const WallHit& hit) const;

  /// Steps the state towards q without a response, and says what is wrong with the walk, the contact and the new state;
  /// empty if nothing is.
  [[nodiscard]] std::string check_step(ParticleState& state, const Vec3& q, ContactList& contacts) const;

  /// Whether the state is what it must always be: the position in the closed simplex named, in a free cell.
  [[nodiscard]] std::string check_state(const ParticleState& state) const;

 private:
  [[nodiscard]] std::string check_walk(SimplexId start, const Vec3& p, const Vec3& q, const oracle::Trace& trace) const;
  [[nodiscard]] std::string check_arrival(const Walk& w, const Vec3& q, const oracle::Trace& trace) const;
  [[nodiscard]] std::string check_wall(const Walk& w, SimplexId start, const Vec3& p, const Vec3& q,
                                       const oracle::Trace& trace) const;
  [[nodiscard]] std::string check_contact(const Contact& contact, std::span<const WallHit> walls,
                                          const ParticleState& before, const ParticleState& after, const Vec3& q,
                                          const oracle::Trace& trace) const;
  /// A distance within which, by an exact proof, no double lies in a closed free simplex: `from` or more, where that
  /// can be shown, else 0.
  [[nodiscard]] double min_distance(const Vec3& x, double from) const;

  MeshData mesh_;
  CellComplex complex_;
  std::unique_ptr<oracle::Oracle> oracle_;
  std::vector<SimplexId> library_;
  std::vector<std::uint32_t> free_simplices_;
};

}  // namespace dartcast::test
