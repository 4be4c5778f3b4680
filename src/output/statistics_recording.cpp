// Writes the files of a run's statistics.
#include "output/statistics_recording.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

#include "formats/file_write.hpp"
#include "output/frame_files.hpp"
#include "output/pathlines.hpp"
#include "output/wall_faces.hpp"

namespace dartcast {

namespace {

constexpr std::string_view planes_header = "step,time,name,forward,backward,flux,mean_age";
constexpr std::string_view crossings_header = "step,time,name,id,direction,age,x,y,z";

constexpr std::string_view residence_header = "left,patch,class,time,count,density,washout";

// A row for each bin up to the last that has counts.
void add_distribution(std::string& table, const std::string& of, const ResidenceTimes& times) {
  for (std::size_t i = 0; i < ResidenceTimes::bin_count && times.washout(i) > 0.0; ++i) {
    const double density = static_cast<double>(times.bins[i]) / (static_cast<double>(times.count) * times.bin);
    table += fmt::format("{},{},{},{},{}\n", of, static_cast<double>(i) * times.bin, times.bins[i], density,
                         times.washout(i));
  }
}

std::string residence_csv(const Simulation& simulation) {
  const std::vector<std::string>& patches = simulation.environment().map().patch_names();
  const Statistics& s = simulation.statistics();
  std::string table = fmt::format("{}\n", residence_header);
  const auto add = [&](std::span<const LeaveTotals> left, const std::string& of_class) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      add_distribution(table, fmt::format("escaped,{},{}", patches[i], of_class), left[i].escaped);
      add_distribution(table, fmt::format("absorbed,{},{}", patches[i], of_class), left[i].absorbed);
    }
  };
  add(s.left, "");
  for (std::size_t i = 0; i < s.left_by_class.size(); i += s.left.size())
    add(std::span(s.left_by_class).subspan(i, s.left.size()), fmt::format("{}", i / s.left.size()));
  return table;
}

std::string walls_name(const RecordingFrame& frame) { return frame_name("walls", frame.step, ".vtp"); }

}  // namespace

StatisticsRecording::StatisticsRecording(const RunFolder& run, const Scene& scene, std::uint64_t every)
    : Recorder(run),
      every_(every),
      compression_(scene.output.compression.value_or(Compression::none)),
      scene_(scene.statistics),
      at_begin_(scene.statistics.options.planes.size()) {
  const StatisticsOptions& options = scene_.options;
  if (!options.planes.empty()) planes_ = run.table("planes.csv", planes_header, &FilesProgress::planes_bytes);
  if (scene_.crossings) crossings_ = run.table("crossings.csv", crossings_header, &FilesProgress::crossings_bytes);
  if (options.pathlines()) pathlines_ = run.table("pathlines.bin", pathlines_header, &FilesProgress::pathlines_bytes);
  if (run.before == nullptr) return;
  interval_begin_ = run.before->interval_begin;
  at_begin_ = run.before->at_begin;
  std::filesystem::remove(folder_ / "pathlines.vtp");
}

void StatisticsRecording::add_step(const Simulation& simulation, const SimulationStep& /*step*/,
                                   const StepSums& /*sums*/) {
  if (scene_.crossings) add_crossings(simulation);
  if (!pathlines_.is_open()) return;
  for (const PathPoint& p : simulation.statistics().path_points) pathlines_.append(packed(p));
  pathlines_.send_many(writing_);
}

void StatisticsRecording::add_crossings(const Simulation& simulation) {
  for (const PlanePassage& p : simulation.statistics().passages) {
    const Vec3& x = p.crossing.point;
    crossings_.print("{},{},{},{},{},{},{},{},{}\n", simulation.steps(), p.time,
                     scene_.options.planes[p.crossing.plane].name, p.id, p.crossing.forward ? 1 : -1, p.age, x.x, x.y,
                     x.z);
  }
  crossings_.send_many(writing_);
}

void StatisticsRecording::add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) {
  if (scene_.options.hits) {
    write_frame_file(
        writing_, folder_ / walls_name(frames.back()),
        wall_faces_file(simulation.environment(), simulation.statistics().hits, scene_.options.impacts).data(),
        compression_);
    write_list(writing_, folder_ / "walls.pvd", frames, walls_name);
  }
  if (simulation.steps() % every_ == 0) end_interval(simulation);
}

// Adds its rows.
void StatisticsRecording::end_interval(const Simulation& simulation) {
  const double duration = simulation.time() - interval_begin_;
  if (!planes_.is_open() || duration <= 0.0) return;
  for (std::size_t i = 0; i < at_begin_.size(); ++i) {
    const PlaneTotals& now = simulation.statistics().planes[i];
    FilesProgress::Plane& before = at_begin_[i];
    const std::uint64_t forward = now.forward.count - before.forward;
    const std::uint64_t backward = now.backward.count - before.backward;
    const double net = static_cast<double>(forward) - static_cast<double>(backward);
    planes_.print("{},{},{},{},{},{},", simulation.steps(), simulation.time(), scene_.options.planes[i].name, forward,
                  backward, net / duration);
    if (forward > 0) planes_.print("{}", (now.forward.sum - before.ages) / static_cast<double>(forward));
    planes_.print("\n");
    before = {now.forward.count, now.backward.count, now.forward.sum};
  }
  interval_begin_ = simulation.time();
}

void StatisticsRecording::save(FilesProgress& progress) {
  progress.planes_bytes = planes_.send(writing_);
  progress.crossings_bytes = crossings_.send(writing_);
  progress.pathlines_bytes = pathlines_.send(writing_);
  progress.interval_begin = interval_begin_;
  progress.at_begin = at_begin_;
}

void StatisticsRecording::finish(const Simulation& simulation) {
  end_interval(simulation);
  planes_.send(writing_);
  if (scene_.options.residence) {
    writing_.add(0, [table = residence_csv(simulation), to = folder_ / "residence.csv"] {
      const std::string_view whole = table;
      replace_file(to, {&whole, 1});
    });
  }
  if (!pathlines_.is_open()) return;
  writing_.add(0, [from = folder_ / "pathlines.bin", to = folder_ / "pathlines.vtp", compression = compression_] {
    write_xml(to, read_packed_pathlines(from).data(), compression, replace_file);
  });
}

}  // namespace dartcast
