// Chooses the writer of a run's frames by the path's ending, and writes those that are text: .usda, .ply, .obj.
#include "output/export_run.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/format_table.hpp"
#include "output/run_files.hpp"
#include "output/run_frames.hpp"
#include "output/vtkhdf.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

template <class... Values>
void put_text(std::string& text, fmt::format_string<Values...> form, Values&&... values) {
  fmt::format_to(std::back_inserter(text), form, std::forward<Values>(values)...);
}

std::string in_brackets(const std::vector<Vec3>& vectors) {
  std::string text = "[";
  for (const Vec3& v : vectors)
    put_text(text, "{}({}, {}, {})", text.size() > 1 ? ", " : "", static_cast<float>(v.x), static_cast<float>(v.y),
             static_cast<float>(v.z));
  return text + "]";
}

template <class Items, class Value>
std::string list_text(const Items& items, Value&& value) {
  std::string text = "[";
  for (const auto& item : items) put_text(text, "{}{}", text.size() > 1 ? ", " : "", value(item));
  return text + "]";
}

// A time code for each frame: the first interval is one.
double code_of(const RunFrames& frames, std::size_t k) {
  const std::vector<double>& t = frames.times();
  return t.size() > 1 ? (t[k] - t[0]) / (t[1] - t[0]) : 0.0;
}

class UsdaFile {
 public:
  explicit UsdaFile(const RunFrames& frames) : frames_(frames) {
    for (std::size_t k = 0; k < frames.size(); ++k) add(k);
  }

  [[nodiscard]] std::string text() const {
    const std::vector<double>& t = frames_.times();
    std::string out = fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"run\"\n    startTimeCode = 0\n    endTimeCode = {}\n    timeCodesPerSecond "
        "= {}\n"
        "    framesPerSecond = 24\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\ndef Xform \"run\"\n{{\n    def "
        "Points "
        "\"particles\"\n    {{\n",
        code_of(frames_, t.size() - 1), t.size() > 1 ? 1.0 / (t[1] - t[0]) : 1.0);
    add_samples(out, "point3f[] points", points_);
    add_samples(out, "vector3f[] velocities", velocities_);
    add_samples(out, "float[] widths", widths_);
    add_samples(out, "int64[] ids", ids_);
    out += "    }\n\n";
    if (is_plane_) {
      out += "    def BasisCurves \"walls\"\n    {\n        uniform token type = \"linear\"\n";
      add_samples(out, "int[] curveVertexCounts", counts_);
    } else {
      out += "    def Mesh \"walls\"\n    {\n        uniform token subdivisionScheme = \"none\"\n";
      add_samples(out, "int[] faceVertexCounts", counts_);
      add_samples(out, "int[] faceVertexIndices", corners_);
    }
    add_samples(out, "point3f[] points", walls_);
    return out + "    }\n}\n";
  }

 private:
  using Samples = std::vector<std::pair<double, std::string>>;

  void add(std::size_t k) {
    const double code = code_of(frames_, k);
    const RunFrame frame = frames_.read(k);
    points_.emplace_back(code, in_brackets(frame.points));
    velocities_.emplace_back(code, in_brackets(frame.velocities));
    widths_.emplace_back(code, list_text(frame.radii, [](double r) { return static_cast<float>(2.0 * r); }));
    ids_.emplace_back(code, list_text(frame.ids, [](std::uint64_t id) { return id; }));
    if (k > 0 && frames_.walls_stand()) return;
    RunWalls walls = frames_.walls(k);
    std::vector<std::size_t> sizes;
    for (std::size_t f = 0; f + 1 < walls.offsets.size(); ++f) sizes.push_back(walls.offsets[f + 1] - walls.offsets[f]);
    add_changed(counts_, code, list_text(sizes, [](std::size_t n) { return n; }));
    is_plane_ = walls.are_lines();
    if (is_plane_) {  // curves name no points: each has its own
      std::vector<Vec3> ends;
      for (const std::uint32_t p : walls.corners) ends.push_back(walls.points[p]);
      walls.points = std::move(ends);
    }
    add_changed(corners_, code, list_text(walls.corners, [](std::uint32_t p) { return p; }));
    walls_.emplace_back(code, in_brackets(walls.points));
  }

  static void add_changed(Samples& samples, double code, std::string value) {
    if (samples.empty() || samples.back().second != value) samples.emplace_back(code, std::move(value));
  }

  static void add_samples(std::string& out, std::string_view name, const Samples& samples) {
    if (samples.size() == 1) {
      put_text(out, "        {} = {}\n", name, samples.front().second);
      return;
    }
    put_text(out, "        {}.timeSamples = {{\n", name);
    for (const auto& [code, value] : samples) put_text(out, "            {}: {},\n", code, value);
    out += "        }\n";
  }

  const RunFrames& frames_;
  Samples points_, velocities_, widths_, ids_;
  Samples counts_, corners_, walls_;
  bool is_plane_ = false;
};

void write_usda(const RunFrames& frames, const fs::path& path) { write_bytes(path, UsdaFile(frames).text()); }

std::string ply_of(const RunFrame& frame) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment time {}\nelement vertex {}\nproperty double x\nproperty double y\nproperty "
      "double z\n"
      "property double vx\nproperty double vy\nproperty double vz\nproperty double radius\nproperty uint "
      "id\nend_header\n",
      frame.time, frame.points.size());
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const Vec3& x = frame.points[i];
    const Vec3& v = frame.velocities[i];
    put_text(text, "{} {} {} {} {} {} {} {}\n", x.x, x.y, x.z, v.x, v.y, v.z, frame.radii[i], frame.ids[i]);
  }
  return text;
}

// Points alone: the format has no place for velocities.
std::string obj_of(const RunFrame& frame) {
  std::string text = fmt::format("# time {}\n", frame.time);
  for (const Vec3& x : frame.points) put_text(text, "v {} {} {}\n", x.x, x.y, x.z);
  for (std::size_t i = 1; i <= frame.points.size(); ++i) put_text(text, "p {}\n", i);
  return text;
}

MeshData surface_of(const RunWalls& walls) {
  MeshData mesh;
  mesh.points = walls.points;
  for (std::size_t f = 0; f + 1 < walls.offsets.size(); ++f) {
    const std::span<const std::uint32_t> corners(walls.corners.data() + walls.offsets[f],
                                                 walls.offsets[f + 1] - walls.offsets[f]);
    if (corners.size() > 2)
      mesh.add_cell(corners.size() == 3   ? CellType::triangle
                    : corners.size() == 4 ? CellType::quadrilateral
                                          : CellType::polygon,
                    corners);
  }
  return mesh;
}

void write_text_series(const RunFrames& frames, const fs::path& path, std::string (*particles)(const RunFrame&)) {
  const fs::path stem = path.parent_path() / path.stem();
  const std::string ending = ending_of(path);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const RunFrame frame = frames.read(k);
    write_bytes(frame_name(stem.string(), frame.step, ending), particles(frame));
    if (k > 0 && frames.walls_stand()) continue;
    const MeshData walls = surface_of(frames.walls(k));
    const std::string name = stem.string() + "_walls";
    if (walls.cell_count() > 0)
      write_mesh(walls, frames.walls_stand() ? name + ending : frame_name(name, frame.step, ending));
  }
}

struct ExportFormat {
  std::string_view ending;
  void (*write)(const RunFrames& frames, const fs::path& path);
};
constexpr std::array export_formats = {
    ExportFormat{".usda", write_usda},
    ExportFormat{".ply",
                 [](const RunFrames& frames, const fs::path& path) { write_text_series(frames, path, ply_of); }},
    ExportFormat{".obj",
                 [](const RunFrames& frames, const fs::path& path) { write_text_series(frames, path, obj_of); }},
    ExportFormat{".vtkhdf", write_vtkhdf}};

}  // namespace

std::vector<std::string> export_endings() {
  std::vector<std::string> endings;
  for (const ExportFormat& format : export_formats) endings.emplace_back(format.ending);
  return endings;
}

std::size_t export_run(const fs::path& run_folder, const fs::path& path) {
  for (const ExportFormat& format : export_formats) {
    if (format.ending != ending_of(path)) continue;
    const RunFrames frames(run_folder);
    format.write(frames, path);
    return frames.size();
  }
  throw InvalidArgument(
      fmt::format("{}: a run is written to files that end in {}", path.string(), in_words(export_endings(), "or")));
}

}  // namespace dartcast
