#include "bench/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "tracking/carry.hpp"

namespace dartcast::bench {

namespace {

constexpr std::size_t block_size = 100;
constexpr std::size_t max_records = 1000000;  // particles times steps of a block
constexpr std::size_t warming_steps = 10;
// All particles cross lattice lines in the same step of eight. Blocks of 20 steps would hold two or three of these, and
// the median would be that of the more expensive half.
constexpr std::size_t lattice_period = 8;
constexpr double same_place = 1e-4;  // cells

template <class Work>
double nanoseconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

// One step: what the others are asked, and what dartcast answers.
struct Record {
  std::uint64_t step = 0;
  std::vector<ParticleState> before;
  std::vector<Segment> segments;
  std::vector<Hit> hits;
};

StepReport advance(Workload& workload) {
  Environment& environment = workload.environment();
  if (workload.deforms()) environment.move();
  return environment.advance(workload.particles(), workload.targets());
}

// Where a scene deforms: once more, without particles, so that each of the others can go through a block's steps.
class Stage {
 public:
  explicit Stage(const Workload& workload) : workload_(workload), complex_(workload.environment().complex()) {}

  [[nodiscard]] const CellComplex& complex() const { return complex_; }
  void set(std::uint64_t step) {
    workload_.positions_after(step, complex_.next_positions());
    complex_.commit_positions();
  }

 private:
  const Workload& workload_;
  CellComplex complex_;
};

class Comparison {
 public:
  Comparison(const WorkloadOptions& options, std::span<const PeerKind> kinds)
      : options_(options), workload_(options), records_(size_of_block(options)) {
    if (options.against_competitors) {
      twin_.emplace(options);
      twin_->environment().set_threads(Threads{1});
      make_competitors(kinds);
    }
    for (const unsigned threads : options.threads) {
      Row& row = rows_.emplace_back();
      row.workload = options;
      row.threads = threads;
      row.cells = workload_.environment().map().cell_count();
      row.wall_triangles = walls_.triangles.size();
    }
    clear();
  }

  std::vector<Row> run() {
    block(std::min(records_.size(), warming_steps));
    clear();
    const std::size_t all = options_.steps * rows_.size();
    for (std::size_t done = 0; done < all; done += records_.size()) block(std::min(records_.size(), all - done));
    for (Row& row : rows_) {
      row.all_series[0].tests = row.counters.orientation.tests;
      for (std::size_t k = 0; k < competitors_.size(); ++k) {
        row.all_series[k + 1].tests = competitors_[k]->tests() - tests_before_[k];
        row.all_series[k + 1].wrong_cells = competitors_[k]->wrong_cells() - wrong_before_[k];
      }
    }
    return std::move(rows_);
  }

 private:
  static std::size_t size_of_block(const WorkloadOptions& options) {
    if (!options.against_competitors) return 1;
    return std::clamp<std::size_t>(max_records / options.particles, 1, std::min(block_size, options.steps));
  }

  [[nodiscard]] const CellComplex& complex() const {
    return stage_ ? stage_->complex() : twin_->environment().complex();
  }

  void make_competitors(std::span<const PeerKind> kinds) {
    if (options_.deforms) stage_.emplace(*twin_);
    walls_ = walls_of(complex());
    walls_.gather(complex().positions(), points_);
    const bool plane = complex().map().dimension() == 2;
    for (const PeerKind& kind : kinds) {
      if (plane && !kind.in_plane) continue;
      names_.push_back(kind.name);
      competitors_.push_back(kind.make({complex(), walls_, points_, twin_->particles().states(), options_.deforms}));
    }
  }

  void clear() {
    tests_before_.clear();
    wrong_before_.clear();
    for (const auto& competitor : competitors_) {
      tests_before_.push_back(competitor->tests());
      wrong_before_.push_back(competitor->wrong_cells());
    }
    for (Row& row : rows_) {
      row.counters = {};
      row.all_series.assign(1, {"dartcast", {}});
      for (const std::string& name : names_) row.all_series.push_back({name, {}});
    }
  }

  void block(std::size_t size) {
    const std::span<Record> records = std::span(records_).first(size);
    for (std::size_t i = 0; i < size; ++i) lead();
    if (competitors_.empty()) return;
    for (Record& record : records) write_down(record);
    for (std::size_t k = 0; k < competitors_.size(); ++k) answer((k + blocks_) % competitors_.size(), records);
    ++blocks_;
  }

  void lead() {
    Row& row = rows_[steps_++ % rows_.size()];
    workload_.environment().set_threads(Threads{row.threads});
    workload_.aim();
    StepReport report;
    row.all_series[0].step_ns.push_back(nanoseconds([&] { report = advance(workload_); }));
    row.counters += report.counters;
    workload_.update_after_edit(report);
  }

  // The twin takes the same step, to the last bit. Were it written down while dartcast leads, that would drive
  // dartcast's data out of the caches.
  void write_down(Record& record) {
    twin_->aim();
    const auto states = twin_->particles().states();
    record.before.assign(states.begin(), states.end());
    const StepReport report = advance(*twin_);
    record.step = twin_->step();
    record.segments.resize(record.before.size());
    for (std::size_t i = 0; i < record.before.size(); ++i) {
      const ParticleState& before = record.before[i];
      Segment& s = record.segments[i];
      s = {options_.deforms ? carried(twin_->environment().complex(), before) : before.position, twin_->targets()[i]};
      if (before.touching_count > 0)
        s.self_hit_epsilon = std::min(1.0, same_place * twin_->cell_size() / norm(s.to - s.from));
    }
    record.hits.assign(record.before.size(), {});
    for (const Contact& c : report.contacts.contacts) {
      const WallHit& wall = report.contacts.walls_of(c).front();
      record.hits[c.particle] = {walls_.number({wall.face, wall.triangle}), c.time_of_impact};
    }
    twin_->update_after_edit(report);
  }

  // Where the walk began: in the geometry after the move.
  static Vec3 carried(const CellComplex& complex, const ParticleState& before) {
    return complex.map().dimension() == 2 ? ridden_in<3>(complex, before) : ridden_in<4>(complex, before);
  }

  template <std::size_t N>
  static Vec3 ridden_in(const CellComplex& complex, const ParticleState& before) {
    const Weights weights = detail::barycentric(previous_space<N>(complex).corners(before.at()), before.position);
    return detail::carried(current_space<N>(complex), before.at(), weights).position;
  }

  // Comes to each step from computing the new positions where the scene deforms, as dartcast does.
  void answer(std::size_t k, std::span<const Record> records) {
    if (stage_) stage_->set(records[0].step - 1);
    for (const Record& record : records) {
      if (stage_) stage_->set(record.step);
      answer(*competitors_[k], rows_[0].all_series[k + 1], record);
    }
  }

  void answer(Competitor& competitor, Series& series, const Record& record) {
    if (options_.deforms) {
      walls_.gather(complex().positions(), points_);
      competitor.write(points_);
    }
    competitor.place(record.before);
    // Copied, so that they are in the caches, as the targets that dartcast is given.
    asked_.assign(record.segments.begin(), record.segments.end());
    answers_.resize(asked_.size());
    series.step_ns.push_back(nanoseconds([&] {
      if (options_.deforms) competitor.refit();
      competitor.cast(asked_, answers_);
    }));
    competitor.translate(answers_);
    for (std::size_t i = 0; i < answers_.size(); ++i) compare(series, record.hits[i], answers_[i], asked_[i]);
  }

  void compare(Series& series, const Hit& ours, const Hit& theirs, const Segment& s) const {
    const double tolerance = same_place * workload_.cell_size();
    const double length = norm(s.to - s.from);
    if (agree(ours, theirs, tolerance / length)) return;
    ++series.disagreements;
    const bool met_at_start = theirs.triangle < Hit::failed && theirs.time * length <= tolerance;
    series.at_start += s.self_hit_epsilon > 0.0 || met_at_start ? 1 : 0;
    series.failed += theirs.triangle == Hit::failed ? 1 : 0;
    series.through += theirs.triangle == Hit::none ? 1 : 0;
    series.stopped += ours.triangle == Hit::none && theirs.triangle < Hit::failed ? 1 : 0;
  }

  // Neither meets a wall, or both the same, or both at the same place: where triangles meet, any of them will do.
  static bool agree(const Hit& a, const Hit& b, double tolerance) {
    if (a.triangle == b.triangle) return true;
    if (a.triangle >= Hit::failed || b.triangle >= Hit::failed) return false;
    return std::abs(a.time - b.time) <= tolerance;
  }

  WorkloadOptions options_;
  Workload workload_;
  std::optional<Workload> twin_;  // for the others
  Walls walls_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<Competitor>> competitors_;
  std::vector<std::uint64_t> tests_before_;
  std::vector<std::uint64_t> wrong_before_;
  std::vector<Record> records_;
  std::optional<Stage> stage_;
  std::vector<Vec3> points_;  // of the walls
  std::vector<Segment> asked_;
  std::vector<Hit> answers_;
  std::vector<Row> rows_;
  std::size_t steps_ = 0;
  std::size_t blocks_ = 0;
};

}  // namespace

double Series::ns_per_particle_step(std::size_t particles) const {
  constexpr std::size_t max_blocks = 50;
  std::size_t size = (step_ns.size() + max_blocks - 1) / max_blocks;
  if (size > lattice_period) size = (size + lattice_period - 1) / lattice_period * lattice_period;
  std::vector<double> means;
  for (std::size_t first = 0; first < step_ns.size(); first += size) {
    const std::size_t count = std::min(size, step_ns.size() - first);
    const auto begin = step_ns.begin() + static_cast<std::ptrdiff_t>(first);
    means.push_back(std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(count), 0.0) /
                    static_cast<double>(count));
  }
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
  std::nth_element(means.begin(), middle, means.end());
  return *middle / static_cast<double>(particles);
}

double Series::mean_ns_per_particle_step(std::size_t particles) const {
  return std::accumulate(step_ns.begin(), step_ns.end(), 0.0) / static_cast<double>(step_ns.size() * particles);
}

double Series::quantile_ns(double share) const {
  std::vector<double> sorted = step_ns;
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[std::clamp<std::size_t>(static_cast<std::size_t>(rank), 1, sorted.size()) - 1];
}

const Series* Row::series(std::string_view name) const {
  const auto found =
      std::find_if(all_series.begin(), all_series.end(), [&](const Series& l) { return l.name == name; });
  return found == all_series.end() ? nullptr : &*found;
}

std::vector<Row> compare(const WorkloadOptions& options, std::span<const PeerKind> kinds) {
  return Comparison(options, kinds).run();
}

}  // namespace dartcast::bench
