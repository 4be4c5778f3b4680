// The paper's own scheme among the competitors.
#include "bench/paper_scheme.hpp"
#include "bench/peers.hpp"

namespace dartcast::bench {

namespace {

class Paper : public Peer {
 public:
  explicit Paper(const PeerScene& scene)
      : walls_(scene.walls), scheme_(scene.complex), results_(scene.particles.size()) {
    scheme_.start(scene.particles);
    targets_.resize(scene.particles.size());
  }

  void write(std::span<const Vec3> /*points*/) override {}  // it reads the complex
  void refit() override { scheme_.moved(); }

  // What it did otherwise than dartcast, and what followed at walls, it takes over.
  void place(std::span<const State> states) override {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const State& s = states[i];
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
    }
  }

  [[nodiscard]] std::uint64_t tests() const override { return tests_; }

 private:
  const Walls& walls_;
  PaperScheme scheme_;
  std::vector<PaperResult> results_;
  std::vector<Vec3> targets_;
  std::uint64_t tests_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_paper(const PeerScene& scene) { return std::make_unique<Paper>(scene); }

}  // namespace dartcast::bench
