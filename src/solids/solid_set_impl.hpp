// The state of a set of solids, and the memory of its steps.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/solids.hpp"
#include "solids/element_touches.hpp"
#include "solids/elements.hpp"
#include "solids/joint_move.hpp"
#include "solids/solid_constraint.hpp"

namespace dartcast {

struct SolidSet::Impl final : MovePartner {
  explicit Impl(Environment& e) : environment(e) {}

  // --- what the set is

  Environment& environment;
  Particles particles;          // all vertices, one solid after another
  std::vector<Vec3> positions;  // theirs
  std::vector<double> inverse_masses;
  std::vector<SolidElement> elements;  // of all solids, in order; vertices are numbers in `particles`
  std::vector<std::uint32_t> solid_of_element;
  std::vector<std::uint32_t> first_vertex = {0};   // one more than solids
  std::vector<std::uint32_t> first_element = {0};  // likewise
  std::vector<double> longest;                     // side of each solid, when it was added
  std::vector<std::vector<std::uint32_t>> meets;   // those before each solid that it meets, sorted

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(longest.size()); }
  [[nodiscard]] std::uint32_t solid_of(std::size_t vertex) const {
    const auto after = std::upper_bound(first_vertex.begin(), first_vertex.end(), vertex);
    return static_cast<std::uint32_t>(after - first_vertex.begin()) - 1;
  }
  [[nodiscard]] std::span<Vec3> of(std::vector<Vec3>& values, std::uint32_t solid) const {
    return {values.data() + first_vertex[solid], first_vertex[solid + 1] - first_vertex[solid]};
  }

  // --- adding (solid_set.cpp)

  SolidPlacement add(const SolidMesh& given, std::span<const std::uint32_t> others);
  [[nodiscard]] SolidPlacement overlap_with(std::uint32_t other, std::span<const Vec3> points,
                                            std::span<const SolidElement> added) const;
  std::uint32_t append(const SolidMesh& mesh, std::span<const SolidElement> added);
  void keep_first(std::uint32_t solids);
  void check_current(const char* caller) const;
  [[nodiscard]] SolidAudit audit() const;
  [[nodiscard]] std::uint32_t audit_other(std::size_t element, const BoxTree& all) const;

  // --- edits (solid_edit.cpp)

  void remove(std::uint32_t solid);
  UpdateReport update_after_edit();
  void find_stuck();
  [[nodiscard]] bool is_stuck(std::uint32_t solid) const;
  void move_all_but_stuck();

  [[nodiscard]] SolidCheckpoint checkpoint() const;
  void restore(const SolidCheckpoint& saved);

  std::vector<SolidPlacement> stuck;  // by solid

  // --- a step (solid_step.cpp)

  void advance(SolidWay given, const SolidStepOptions& options);
  void prepare(SolidWay given, const SolidStepOptions& options);
  double plan(const VertexMotion& walls) override;
  bool shorten(double share, const VertexMotion& walls) override;
  void after_move() override;

  // A cell that an element reaches, and when it becomes flat.
  struct Flat {
    std::uint32_t solid = 0;
    double time = 0.0;
  };
  // Consecutive places in `looked_at`: elements of one solid.
  struct Run {
    std::size_t begin;
    std::size_t end;
  };
  static constexpr std::uint32_t elements_in_run = 2 * elements_in_group;
  // Part of a detection: consecutive runs.
  struct Part {
    TouchFinder finder;
    std::vector<SolidElement> elements;  // of a run
    std::vector<Cell> cells;             // theirs
    std::vector<ElementTouch> touches;   // of all runs; their elements are numbers in SolidSet::Impl::elements
    std::vector<Flat> flats;
  };
  struct Progress {
    // From the last detection. Times above 1: none in the step.
    std::vector<ElementTouch> touches;
    std::size_t known_touches = 0;  // the first of them: from an earlier detection, and as they were then
    double touch_time = 2.0;
    double flat_time = 2.0;  // when a cell that the solid reaches becomes flat
    // From all detections of the step.
    std::vector<SolidConstraint> constraints;

    [[nodiscard]] double free_until() const { return std::min(touch_time, flat_time); }
    [[nodiscard]] bool is_free() const { return free_until() > 1.0; }
    // Before a detection that looks at the elements of the other touches again.
    void keep_touches(std::size_t first);
  };
  // Where a solid stops: after a share of a slice.
  struct Stop {
    unsigned slice = 0;
    double share = 0.0;
  };
  static constexpr Stop no_stop = {std::numeric_limits<unsigned>::max(), 0.0};
  using Solids = std::vector<std::uint32_t>;

  [[nodiscard]] Solids all_but_stuck() const;
  [[nodiscard]] Solids movers(const VertexMotion& walls) const;
  void start(SolidWay given, const SolidStepOptions& options, const char* caller);
  static void check_range(std::span<const Vec3> given, const char* caller);
  void aim();
  void put_on_way(std::uint32_t solid, double share, std::span<Vec3> place) const;
  [[nodiscard]] bool has_stopped(std::uint32_t solid) const { return stops[solid].slice < slice; }
  [[nodiscard]] double way_made(std::uint32_t solid, double walls_made) const;
  double plan_slice(const VertexMotion& walls);
  void begin_way();
  void choose_slices(const VertexMotion& walls);
  void choose_margins(const VertexMotion& walls);
  void end_slice(const VertexMotion& walls);
  // The simplices that hold the vertices at the end of the way; none: it is straight.
  [[nodiscard]] std::span<const SimplexId> ends() const {
    return way.slices == 1 ? std::span<const SimplexId>() : std::span<const SimplexId>(simplices);
  }
  VertexMotion walls_in(unsigned piece, unsigned pieces, const VertexMotion& walls);
  void go_on(std::uint32_t solid, double walls_made);
  void correct_in_rounds(Solids& open, const VertexMotion& walls, const SolidStepOptions& options);
  void correct(std::uint32_t solid, const SolidStepOptions& options);
  void go(std::uint32_t solid, double share);
  void cut_each(Solids& open, const VertexMotion& walls);
  void keep_first_touches(const Solids& cut, const SolidStepOptions& options);
  void commit_at_rest();
  void report();

  // --- solids that meet each other (solid_pairs.cpp)

  struct Pair {
    std::uint32_t solid;
    std::uint32_t other;
    double margin;
    std::vector<ElementTouch> touches;
  };
  [[nodiscard]] bool have_pairs() const;
  [[nodiscard]] std::span<const SolidElement> elements_of_solid(std::uint32_t solid) const;
  [[nodiscard]] bool moves(std::uint32_t solid, std::span<const Vec3> to) const;
  [[nodiscard]] std::vector<Pair> near_pairs(std::span<const Vec3> to, std::span<const double> kept) const;
  void look_at_pairs(std::vector<Pair>& pairs, std::span<const Vec3> to) const;
  [[nodiscard]] std::vector<Pair> touching_pairs(std::span<const Vec3> to) const;
  void leave_margins_to_solids();
  [[nodiscard]] Solids to_blame(const Pair& pair, const SolidConstraint& meeting) const;
  void stop_at_solids(Solids& squeezed, const VertexMotion& walls);
  void report_meetings();

  // --- what touches on the way (solid_detection.cpp)

  [[nodiscard]] std::uint64_t pairs_so_far() const;
  void detect(const Solids& solids, std::span<const Vec3> to, const VertexMotion& walls);
  void detect_corrected(const Solids& solids, const VertexMotion& walls);
  void look_at_all_of(std::uint32_t solid);
  void look_at_corrected_of(std::uint32_t solid);
  void add_runs(std::size_t begin);
  void look(const SolidMotion& motion, const VertexMotion& walls);
  void look_at(const Run& run, const SolidMotion& motion, const VertexMotion& walls, Part& part);
  void gather(std::span<const Part> found);

  SolidStepOptions step_options;
  SolidWay way;
  unsigned slice = 0;
  std::vector<double> margins;  // what each solid keeps from walls in this step
  std::vector<Stop> stops;
  std::vector<double> shares;                  // of the slice, for each solid
  std::vector<Vec3> from;                      // where the slice starts
  std::vector<SimplexId> simplices;            // there
  std::array<AlignedVector<Vec3>, 2> between;  // the walls where slices end
  std::vector<Vec3> wanted;                    // targets of the caller
  std::vector<Vec3> targets;                   // of the slice, corrected
  std::vector<Vec3> uncorrected;               // before the last correction
  std::vector<Vec3> reached;                   // a share of the slice
  std::vector<SolidConstraint> first_touches;  // of the solids that are cut
  std::vector<SolidConstraint> meetings;       // of solids that stop at each other, whose elements are the walls
  std::vector<Progress> progress;
  std::vector<Part> parts;
  std::vector<std::uint32_t> looked_at;  // elements, in a detection
  std::vector<Run> work;                 // all of them
  std::uint64_t pairs_before = 0;
  SolidStep last;
};

}  // namespace dartcast
