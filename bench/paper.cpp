// The paper's own schemes among the competitors.
#include <type_traits>

#include "bench/competitors.hpp"
#include "bench/paper_scheme.hpp"
#include "bench/paper_scheme_2d.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast::bench {

namespace {

// Whether x is in the closed cell of the plane.
bool in_polygon(const CellComplex& complex, Cell cell, const Vec3& x) {
  const CombinatorialMap& map = complex.map();
  const auto at = [&](Dart d) { return complex.positions()[map.origin(d).value]; };
  for (std::uint16_t n = 0; n < map.shape(cell).dart_count(); ++n) {
    const Dart d = {cell, n};
    if (orient2d(at(d), at(map.phi1(d)), x) == Sign::negative) return false;
  }
  return true;
}

// Scheme: PaperScheme, or PaperScheme2D in the plane.
template <class Scheme>
class Paper : public Competitor {
 public:
  explicit Paper(const PeerScene& scene)
      : complex_(scene.complex), walls_(scene.walls), scheme_(scene.complex), results_(scene.particles.size()) {
    scheme_.start(scene.particles);
    targets_.resize(scene.particles.size());
  }

  void write(std::span<const Vec3> /*points*/) override {}  // it reads the complex
  void refit() override { scheme_.moved(); }

  // Takes over dartcast's answers where it differed, and what followed at walls.
  void place(std::span<const ParticleState> states) override {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const ParticleState& s = states[i];
      if (scheme_.position(i) != s.position || scheme_.cell(i) != s.cell) scheme_.place(i, s.position, s.cell);
    }
  }

  void cast(std::span<const Segment> segments, std::span<Hit> /*hits*/) override {
    for (std::size_t i = 0; i < segments.size(); ++i) targets_[i] = segments[i].to;
    scheme_.advance(targets_, results_);
  }

  // It meets faces, not their triangles: the first stands for the face.
  void translate(std::span<Hit> hits) override {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const PaperResult& r = results_[i];
      hits[i] = {};
      if (r.end == PaperEnd::collision) hits[i] = {walls_.number({r.wall, 0}), r.time};
      if (r.end == PaperEnd::error) hits[i].triangle = Hit::failed;
      tests_ += r.tests;
      if constexpr (std::is_same_v<Scheme, PaperScheme2D>) {
        const bool orphaned = r.end == PaperEnd::arrived && !in_polygon(complex_, scheme_.cell(i), scheme_.position(i));
        wrong_cells_ += orphaned ? 1 : 0;
      }
    }
  }

  [[nodiscard]] std::uint64_t tests() const override { return tests_; }
  [[nodiscard]] std::uint64_t wrong_cells() const override { return wrong_cells_; }

 private:
  const CellComplex& complex_;
  const Walls& walls_;
  Scheme scheme_;
  std::vector<PaperResult> results_;
  std::vector<Vec3> targets_;
  std::uint64_t tests_ = 0;
  std::uint64_t wrong_cells_ = 0;
};

}  // namespace

std::unique_ptr<Competitor> make_paper(const PeerScene& scene) {
  if (scene.complex.map().dimension() == 2) return std::make_unique<Paper<PaperScheme2D>>(scene);
  return std::make_unique<Paper<PaperScheme>>(scene);
}

}  // namespace dartcast::bench
