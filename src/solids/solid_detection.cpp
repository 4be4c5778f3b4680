// The touches of solids on the way from their positions, for all threads.
//
//  detect()            looks at all elements of the given solids
//  detect_corrected()  looks again at those whose targets a correction moved; the others keep their touches
//
// Both make a list of elements (`looked_at`) in runs, look at each run, and gather what was found. The lengths of the runs
// and of the parts depend on the elements alone, so the order of the touches does not depend on the threads.
#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"
#include "solids/solid_set_impl.hpp"

namespace dartcast {

std::uint64_t SolidSet::Impl::pairs_so_far() const {
  std::uint64_t pairs = 0;
  for (const Part& part : parts) pairs += part.finder.pairs();
  return pairs;
}

void SolidSet::Impl::Progress::keep_touches(std::size_t first) {
  touches.resize(first);
  known_touches = first;
  touch_time = 2.0;
  for (const ElementTouch& t : touches) touch_time = std::min(touch_time, t.time);
}

void SolidSet::Impl::detect(const Solids& solids, std::span<const Vec3> to, const VertexMotion& walls) {
  looked_at.clear();
  work.clear();
  for (const std::uint32_t s : solids) look_at_all_of(s);
  look({from, to}, walls);
}

// Precondition: the last detection looked at the way of these solids to `uncorrected`, and correct() made `targets` of it.
void SolidSet::Impl::detect_corrected(const Solids& solids, const VertexMotion& walls) {
  looked_at.clear();
  work.clear();
  for (const std::uint32_t s : solids) {
    if (progress[s].flat_time > 1.0) look_at_corrected_of(s);
    if (progress[s].flat_time <= 1.0) look_at_all_of(s);  // which element reached the cell is not known
  }
  look({from, targets}, walls);
}

void SolidSet::Impl::look_at_all_of(std::uint32_t solid) {
  progress[solid].keep_touches(0);
  progress[solid].flat_time = 2.0;
  const std::size_t begin = looked_at.size();
  looked_at.resize(begin + (first_element[solid + 1] - first_element[solid]));
  std::iota(looked_at.begin() + static_cast<std::ptrdiff_t>(begin), looked_at.end(), first_element[solid]);
  add_runs(begin);
}

void SolidSet::Impl::look_at_corrected_of(std::uint32_t solid) {
  const auto is_corrected = [&](std::uint32_t e) {
    const auto& v = elements[e].vertex;
    return std::any_of(v.begin(), v.end(), [&](std::uint32_t i) { return targets[i] != uncorrected[i]; });
  };
  Progress& p = progress[solid];
  const auto kept = std::stable_partition(p.touches.begin(), p.touches.end(),
                                          [&](const ElementTouch& t) { return !is_corrected(t.element); });
  p.keep_touches(static_cast<std::size_t>(kept - p.touches.begin()));
  const std::size_t begin = looked_at.size();
  for (std::uint32_t e = first_element[solid]; e < first_element[solid + 1]; ++e) {
    if (is_corrected(e)) looked_at.push_back(e);
  }
  add_runs(begin);
}

// Runs for all that is listed from here on.
void SolidSet::Impl::add_runs(std::size_t begin) {
  for (; begin < looked_at.size(); begin += elements_in_run)
    work.push_back({begin, std::min<std::size_t>(begin + elements_in_run, looked_at.size())});
}

void SolidSet::Impl::look(const SolidMotion& motion, const VertexMotion& walls) {
  const std::size_t grain = std::max<std::size_t>(chunk_count(work.size(), 256), 1);
  const std::size_t used = chunk_count(work.size(), grain);
  if (parts.size() < used) parts.resize(used);
  parallel_for(work.size(), grain, environment.threads(), [&](std::size_t begin, std::size_t end) {
    Part& part = parts[begin / grain];
    part.touches.clear();
    part.flats.clear();
    const auto cell_of = [&](std::size_t i) { return simplices[elements[looked_at[work[i].begin]].vertex[0]].cell; };
    for (std::size_t i = begin; i < end; ++i) {
      if (i + 2 < end) prefetch_record(environment.complex(), cell_of(i + 2));
      if (i + 1 < end) prefetch_cell(environment.complex(), cell_of(i + 1), walls);
      look_at(work[i], motion, walls, part);
    }
  });
  gather(std::span<const Part>(parts).first(used));
}

void SolidSet::Impl::look_at(const Run& run, const SolidMotion& motion, const VertexMotion& walls, Part& part) {
  const auto numbers = std::span<const std::uint32_t>(looked_at).subspan(run.begin, run.end - run.begin);
  part.elements.resize(numbers.size());
  part.cells.resize(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    part.elements[i] = elements[numbers[i]];
    part.cells[i] = simplices[part.elements[i].vertex[0]].cell;
  }
  const std::size_t first = part.touches.size();
  const SolidMotion mine = {motion.from, motion.to, margins[solid_of_element[numbers.front()]]};
  const auto flat = part.finder.find(environment.complex(), {part.elements, part.cells}, mine, walls, part.touches);
  for (std::size_t i = first; i < part.touches.size(); ++i) part.touches[i].element = numbers[part.touches[i].element];
  if (flat) part.flats.push_back({solid_of_element[numbers.front()], *flat});
}

// By part, then by element.
void SolidSet::Impl::gather(std::span<const Part> found) {
  for (const Part& part : found) {
    for (const ElementTouch& touch : part.touches) {
      Progress& p = progress[solid_of_element[touch.element]];
      p.touches.push_back(touch);
      p.touch_time = std::min(p.touch_time, touch.time);
    }
    for (const Flat& f : part.flats) progress[f.solid].flat_time = std::min(progress[f.solid].flat_time, f.time);
  }
}

}  // namespace dartcast
