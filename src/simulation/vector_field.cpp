// Interpolates a field in space and time, and carries it with a mesh that deforms.
#include "dartcast/vector_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "simulation/sample_times.hpp"

namespace dartcast {

namespace {

constexpr std::size_t value_grain = 4096;

// The linear map that takes the edges of one simplex to those of another, applied to u.
Vec3 mapped(const Corners& from, const Corners& to, const Vec3& u) {
  const Vec3 a = from[1] - from[0];
  const Vec3 b = from[2] - from[0];
  const Vec3 c = from[3] - from[0];
  const double volume = dot(a, cross(b, c));
  if (!(volume > 0.0)) return u;
  const Vec3 moved = (to[1] - to[0]) * dot(cross(b, c), u) + (to[2] - to[0]) * dot(cross(c, a), u) +
                     (to[3] - to[0]) * dot(cross(a, b), u);
  return moved * (1.0 / volume);
}

void check_times(const FieldSamples& s) {
  const auto fail = [&](const std::string& message) { throw InvalidArgument(fmt::format("{}: {}", s.name, message)); };
  if (s.times.empty()) fail("there is no sample; give at least one time");
  if (!s.read) fail("there is nothing to read its values with");
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    if (!std::isfinite(s.times[k])) fail(fmt::format("time {} (counted from 0) is not finite", k));
    if (k > 0 && !(s.times[k] > s.times[k - 1]))
      fail(fmt::format("times must increase, but time {} (counted from 0) is {} s, after {} s", k, s.times[k],
                       s.times[k - 1]));
  }
  if (s.period == 0.0) return;
  const double span = s.times.back() - s.times.front();
  if (s.times.size() < 2) fail("it has a period, but a single sample: give samples at two times at least");
  if (!std::isfinite(s.period) || !(s.period >= span))
    fail(fmt::format("the period is {} s: it must not be less than the {} s from the first sample to the last",
                     s.period, span));
}

Vec3 blended(const std::array<const Vec3*, 4>& from, const SampleWeights& use, std::size_t i) {
  const Vec3& a = from[0][i];
  if (use.count == 1) return a;
  if (use.count == 2) return a + (from[1][i] - a) * use.weights[1];
  Vec3 sum = a * use.weights[0];
  for (std::size_t k = 1; k < use.count; ++k) sum += from[k][i] * use.weights[k];
  return sum;
}

FieldSamples steady_samples(std::span<const Vec3> values) {
  return field_samples({0.0}, {std::vector<Vec3>(values.begin(), values.end())});
}

}  // namespace

FieldSamples field_samples(std::vector<double> times, std::vector<std::vector<Vec3>> values, FieldPlace place,
                           double period) {
  if (times.size() != values.size())
    throw InvalidArgument(fmt::format("the field has {} times for {} lists of values", times.size(), values.size()));
  FieldSamples samples;
  samples.place = place;
  samples.times = std::move(times);
  samples.period = period;
  samples.read = [lists = std::move(values)](std::size_t k) { return lists.at(k); };
  return samples;
}

VectorField::VectorField(const CellComplex& complex, std::span<const Vec3> values, FieldFrame frame)
    : VectorField(complex, steady_samples(values), frame) {}

VectorField::VectorField(const CellComplex& complex, FieldSamples samples, FieldFrame frame)
    : samples_(std::move(samples)), frame_(frame), plane_(complex.map().dimension() == 2) {
  check_times(samples_);
  times_of_samples_ =
      std::make_shared<const SampleTimes>(samples_.name, samples_.times, samples_.interpolation, samples_.period);
  if (samples_.place == FieldPlace::cells) {
    find_rows(complex);
  } else {
    count_ = complex.point_count();
  }
  if (frame == FieldFrame::mesh) rest_.assign(complex.positions().begin(), complex.positions().end());
  values_.push_back(read(0));
  if (steady()) {
    samples_.read = {};
  } else {
    held_.emplace(0, values_.front());
  }
  times_ = {samples_.times.front()};
  spread(complex, values_.front());
}

// Cells that edits make keep the source of the cell that they are made from.
void VectorField::find_rows(const CellComplex& complex) {
  std::vector<std::uint32_t> sources;
  for (const Cell c : complex.map().cells()) sources.push_back(complex.map().source(c));
  std::sort(sources.begin(), sources.end());
  if (std::adjacent_find(sources.begin(), sources.end()) != sources.end())
    throw InvalidArgument(fmt::format(
        "{}: two cells of the mesh have the same source, so values at cells fit no one: clear MeshData::source",
        samples_.name));
  count_ = sources.size();
  row_.resize(sources.empty() ? 0 : std::size_t{sources.back()} + 1);
  for (std::size_t i = 0; i < sources.size(); ++i) row_[sources[i]] = static_cast<std::uint32_t>(i);
}

void VectorField::check(std::size_t k, std::span<const Vec3> values) const {
  const std::string name =
      steady() ? samples_.name
               : fmt::format("{}, sample {} (counted from 0, {} s)", samples_.name, k, samples_.times[k]);
  const bool cells = samples_.place == FieldPlace::cells;
  const char* item = cells ? "cell" : "point";
  if (values.size() != count_)
    throw InvalidArgument(fmt::format("{} has {} values for {} {}s", name, values.size(), count_, item));
  const auto bad = std::find_if_not(values.begin(), values.end(), is_finite);
  if (bad != values.end())
    throw InvalidArgument(fmt::format("{}: the value at {} {} is not finite", name, item, bad - values.begin()));
  if (!plane_ || !samples_.vectors) return;
  const auto out = std::find_if(values.begin(), values.end(), [](const Vec3& v) { return v.z != 0.0; });
  if (out != values.end())
    throw InvalidArgument(fmt::format("{}: the value at {} {} is ({}, {}, {}): in the plane its z must be 0", name,
                                      item, out - values.begin(), out->x, out->y, out->z));
}

std::vector<Vec3> VectorField::read(std::size_t k) const {
  std::vector<Vec3> values = samples_.read(k);
  check(k, values);
  return values;
}

const std::vector<Vec3>& VectorField::sample(std::size_t k) {
  const auto at = held_.find(k);
  return at != held_.end() ? at->second : held_.emplace(k, read(k)).first->second;
}

// Those that times from `begin` to `end` need, in their order.
std::vector<std::size_t> VectorField::needed(double begin, double end) const {
  const SampleWeights first = times_of_samples_->at(begin);
  const SampleWeights last = times_of_samples_->at(end);
  const std::size_t size = times_of_samples_->size();
  const std::size_t from = first.samples[0];
  const std::size_t to = last.samples[last.count - 1];
  // In a cycle the last sample that is needed may be the first one again, after a whole turn.
  const bool turns =
      times_of_samples_->repeat() && (end - begin >= samples_.period || size < times_of_samples_->needed());
  std::vector<std::size_t> numbers = {from};
  for (std::size_t k = from; turns || k != to;) {
    k = (k + 1) % size;
    if (k == from) break;  // all of them
    numbers.push_back(k);
  }
  return numbers;
}

void VectorField::hold(double begin, double end) {
  if (steady()) return;
  const std::vector<std::size_t> numbers = needed(begin, end);
  for (const std::size_t k : numbers) sample(k);
  std::erase_if(held_,
                [&](const auto& s) { return std::find(numbers.begin(), numbers.end(), s.first) == numbers.end(); });
}

void VectorField::set_times(std::span<const double> times, const CellComplex& complex, Threads threads) {
  if (steady() || std::equal(times.begin(), times.end(), times_.begin(), times_.end())) return;
  times_.clear();
  values_.resize(times.size());
  for (std::size_t m = 0; m < times.size(); ++m) {
    const SampleWeights use = times_of_samples_->at(times[m]);
    std::array<const Vec3*, 4> from{};
    for (std::size_t k = 0; k < use.count; ++k) from[k] = sample(use.samples[k]).data();
    std::vector<Vec3>& out = values_[m];
    out.resize(count_);
    parallel_for(count_, value_grain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = blended(from, use, i);
    });
    spread(complex, out);
  }
  times_.assign(times.begin(), times.end());
}

// From the mesh's points to all vertices: those that edits made, and Steiner points, which take values as they take
// positions.
void VectorField::spread(const CellComplex& complex, std::vector<Vec3>& values) const {
  if (samples_.place == FieldPlace::cells) return;
  dartcast::update_after_edit(later_, complex.positions().size(), values);
  complex.steiner_weights().compute(values);
}

void VectorField::update_after_edit(const ComplexEditReport& edit, const CellComplex& complex) {
  if (edit.replaced) throw InvalidArgument("vector field: the mesh was replaced: make a new field on its points");
  const auto take_over = [&](std::vector<Vec3>& values) {
    dartcast::update_after_edit(edit, complex.positions().size(), values);
    complex.steiner_weights().compute(values);
  };
  if (frame_ == FieldFrame::mesh) take_over(rest_);
  if (samples_.place == FieldPlace::cells) return;
  if (steady()) {
    take_over(values_.front());
    return;
  }
  later_.placed.insert(later_.placed.end(), edit.placed.begin(), edit.placed.end());
  times_.clear();
}

Vec3 VectorField::at(const CellComplex& complex, SimplexId simplex, const std::array<double, 4>& w, const Corners& now,
                     std::size_t moment) const {
  const std::vector<Vec3>& values = values_[steady() ? 0 : moment];
  const auto v = complex.vertices(simplex);
  const Vec3 u = samples_.place == FieldPlace::cells ? values[row_[complex.map().source(simplex.cell)]]
                                                     : (values[v[0].value] * w[0] + values[v[1].value] * w[1]) +
                                                           (values[v[2].value] * w[2] + values[v[3].value] * w[3]);
  switch (frame_) {
    case FieldFrame::space: return u;
    case FieldFrame::mesh: break;
  }
  const Corners rest = {rest_[v[0].value], rest_[v[1].value], rest_[v[2].value], rest_[v[3].value]};
  return mapped(complex.map().dimension() == 2 ? raised(rest) : rest, now, u);
}

}  // namespace dartcast
