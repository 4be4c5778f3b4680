// Chooses what a report shows of a recording.
//
// Phases: the frames that are on schedule; of these an even choice; the ids in it; of these an even choice.
#include "report/selection.hpp"

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// A run that was cut off has a last frame off the schedule. It does not count if the run went on.
std::vector<ReportSelection::Frame> frames_of(const RecordedFile& file) {
  std::vector<ReportSelection::Frame> frames;
  std::size_t walls = 0;
  const std::uint64_t every = std::max<std::uint64_t>(file.header().every, 1);
  for (std::size_t i = 0; i < file.chunks().size(); ++i) {
    if (file.chunks()[i].tag == RecordedWalls::tag) walls = i;
    if (file.chunks()[i].tag != RecordedFrame::tag) continue;
    if (walls == 0) throw Error("report.bin is damaged: a frame comes before the walls");
    const RecordedFile::Moment moment = file.moment(file.chunks()[i]);
    while (!frames.empty() && (frames.back().step >= moment.step || frames.back().step % every != 0)) frames.pop_back();
    frames.push_back({i, walls, moment.step, moment.time});
  }
  if (frames.empty()) throw Error("report.bin has no frame: run at least one step with every > 0 in [output]");
  return frames;
}

// `count` of `size` places: the first and the last are among them.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
  std::vector<std::size_t> places;
  const std::size_t n = std::min(size, count);
  for (std::size_t i = 0; i < n; ++i)
    places.push_back(
        n == 1 ? 0 : static_cast<std::size_t>((static_cast<unsigned long long>(size - 1) * i + (n - 1) / 2) / (n - 1)));
  return places;
}

}  // namespace

ReportSelection select(const RecordedFile& file, const ReportOptions& options) {
  ReportSelection s;
  const std::vector<ReportSelection::Frame> all = frames_of(file);
  s.recorded_frames = all.size();
  for (const std::size_t i : evenly(all.size(), options.frames)) s.frames.push_back(all[i]);
  std::vector<std::uint64_t> ids;
  std::uint64_t stride = 1;
  for (const ReportSelection::Frame& f : s.frames) {
    const RecordedFrame& frame = s.recorded.emplace_back(file.read<RecordedFrame>(file.chunks()[f.chunk]));
    ids.insert(ids.end(), frame.ids.begin(), frame.ids.end());
    stride = std::max(stride, frame.stride);
    s.all_ids = std::max(s.all_ids, frame.all);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<std::uint64_t> kept;
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(kept), [&](std::uint64_t id) { return id % stride == 0; });
  s.recorded_ids = kept.size();
  for (const std::size_t i : evenly(kept.size(), options.particles)) {
    s.slot.emplace(kept[i], static_cast<std::uint32_t>(s.ids.size()));
    s.ids.push_back(kept[i]);
  }
  return s;
}

}  // namespace dartcast
