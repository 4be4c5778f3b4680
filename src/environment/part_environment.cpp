// The exchange of travellers between ranks, with the data of their users.
#include "environment/part_environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "base/bytes.hpp"
#include "base/digest.hpp"
#include "dartcast/error.hpp"
#include "environment/environment_members.hpp"
#include "environment/particle_details.hpp"
#include "mesh/cell_types.hpp"
#include "tracking/batch/batch_stepper.hpp"

namespace dartcast {

namespace {

class RankTraffic final : public detail::PartTraffic {
 public:
  /// `to`: for the bytes to each rank; it keeps its memory.
  RankTraffic(const PartCells& cells, Ranks& ranks, std::vector<ByteWriter>& to, TravelData& data,
              TrafficCounts& counts)
      : cells_(cells), ranks_(ranks), to_(to), data_(data), counts_(counts) {}

  [[nodiscard]] const PartCells& cells() const override { return cells_; }

  std::vector<Traveller> exchange(std::vector<Traveller> leaving, bool& over) override {
    std::uint64_t sent = leaving.size();
    ranks_.sum({&sent, 1});
    over = sent == 0;
    if (over) return {};
    for (ByteWriter& w : to_) w.clear();
    for (const Traveller& t : leaving) {
      pack(t, to_[t.to]);
      to_[t.to].put(data_.leave(t.step.particle, t.met));
    }
    std::vector<std::string> bytes;
    for (const ByteWriter& w : to_) {
      bytes.push_back(w.bytes());
      counts_.bytes += w.bytes().size();
    }
    ++counts_.rounds;
    counts_.sent += leaving.size();
    std::vector<Traveller> come;
    for (const std::string& b : ranks_.exchange(std::move(bytes))) {
      for (ByteReader in(b); !in.at_end();) {
        unpack(in, come.emplace_back());
        data_.come(in.take_text());
      }
    }
    return come;
  }

 private:
  const PartCells& cells_;
  Ranks& ranks_;
  std::vector<ByteWriter>& to_;
  TravelData& data_;
  TrafficCounts& counts_;
};

}  // namespace

PartEnvironment::PartEnvironment(Environment& environment, const MeshPart& part, Ranks& ranks)
    : environment_(environment), ranks_(ranks), cells_(part_cells(part)), to_(ranks.size()) {
  check(part);
}

void PartEnvironment::change(const MeshPart& part) {
  Environment next(part.mesh, environment_.threads());
  std::swap(environment_.members_, next.members_);
  cells_ = part_cells(part);
  check(part);
}

void PartEnvironment::check(const MeshPart& part) const {
  if (environment_.map().dimension() != 3)
    throw InvalidArgument("partition: meshes of the plane cannot be spread by cells; spread the particles");
  std::uint64_t steiner = environment_.complex().positions().size() - environment_.positions().size();
  ranks_.sum({&steiner, 1});
  if (steiner > 0)
    throw InvalidArgument(
        "partition: some cells need Steiner points, and cannot be spread by cells; spread the particles, or mend the "
        "mesh");
  check_ghosts(part);
}

namespace {

std::uint64_t digest_of(const MeshData& mesh, std::size_t c) {
  ByteWriter corners;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
    for (const std::uint32_t p : face) corners.put(mesh.points[p]);
  });
  return digest(corners.bytes());
}

}  // namespace

// Each rank says to the others which of their cells it has as ghosts.
void PartEnvironment::check_ghosts(const MeshPart& part) const {
  std::vector<ByteWriter> ghosts(ranks_.size());
  std::unordered_map<std::uint32_t, std::size_t> own;
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    if (part.owners[c] >= ranks_.size())
      throw InvalidMesh(
          fmt::format("partition: cell {} is of part {} of {}", part.cells[c], part.owners[c], ranks_.size()));
    if (part.owners[c] == ranks_.rank()) {
      own.emplace(part.handles[c].value, c);
    } else {
      ghosts[part.owners[c]].put(part.handles[c]);
      ghosts[part.owners[c]].put(digest_of(part.mesh, c));
    }
  }
  std::vector<std::string> bytes;
  for (const ByteWriter& g : ghosts) bytes.push_back(g.bytes());
  bytes = ranks_.exchange(std::move(bytes));
  for (std::size_t rank = 0; rank < bytes.size(); ++rank) {
    for (ByteReader in(bytes[rank]); !in.at_end();) {
      const auto handle = in.take<Cell>();
      const auto seen = in.take<std::uint64_t>();
      const auto found = own.find(handle.value);
      if (found == own.end() || digest_of(part.mesh, found->second) != seen)
        throw InvalidMesh(fmt::format(
            "partition: ranks {} and {} have parts of different meshes: the first has a cell beside its own that "
            "the second does not have",
            rank, ranks_.rank()));
    }
  }
}

// An empty set does not know whether it has followed the last move; those of the other ranks do.
bool PartEnvironment::moves_any(const Particles& particles) const {
  std::uint64_t count = particles.size() > 0 && environment_.awaits_advance(particles) ? 1 : 0;
  ranks_.sum({&count, 1});
  return count > 0;
}

// One rank at most finds a position in a cell of its own.
std::vector<AddResult> PartEnvironment::add(Particles& particles, std::span<const Vec3> positions) {
  constexpr std::uint64_t free = 1;
  constexpr std::uint64_t blocked = std::uint64_t{1} << 32U;
  const std::vector<Location> locations = environment_.locate(positions);
  std::vector<std::uint64_t> found(positions.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool own = locations[i].place != Place::outside && cells_.is_own(locations[i].simplex.cell);
    if (own) found[i] = locations[i].place == Place::free ? free : blocked;
  }
  const std::vector<std::uint64_t> own = found;
  ranks_.sum(found);
  const std::size_t before = particles.size();
  std::vector<AddResult> added(positions.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    added[i].location.place = found[i] == free ? Place::free : found[i] == 0 ? Place::outside : Place::blocked;
    if (own[i] != free) continue;
    added[i] = {locations[i], static_cast<std::uint32_t>(particles.size())};
    if (environment_.add(particles, locations[i].simplex, positions[i])) continue;
    std::vector<std::uint8_t> marks(particles.size(), 1);
    std::fill_n(marks.begin(), before, 0);
    particles.remove(marks);
    throw InvalidArgument(fmt::format("add: position {} is in a cell that is not valid; mend the mesh", i));
  }
  return added;
}

StepReport PartEnvironment::advance(Particles& particles, std::span<const Vec3> targets, const ContactCallback& respond,
                                    const StepOptions& options, TravelData& data, std::vector<std::uint8_t>& gone) {
  environment_.check_advance(particles, options);
  if (targets.size() != particles.size())
    throw InvalidArgument(fmt::format("advance: {} targets for {} particles", targets.size(), particles.size()));
  const Environment::Members& members = *environment_.members_;
  const bool moved = moves_any(particles);
  members.adopt(particles);
  Particles::Details& details = particles.details();
  details.index.reset();
  const detail::BatchStepper stepper(environment_.complex(), moved, environment_.threads(), options, respond, true);
  RankTraffic traffic(cells_, ranks_, to_, data, traffic_);
  StepReport report =
      stepper.advance_in_part({particles.states_, details.weights, details.cache}, targets, respond, traffic, gone);
  details.moves = members.moves;
  return report;
}

}  // namespace dartcast
