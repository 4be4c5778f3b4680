// The report on a mesh file, for people.
#include "output/mesh_report_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace dartcast {
namespace {

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings) {
  auto list = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    list.push_back({{"kind", f.kind}, {"count", f.count}, {"first", f.first}, {"message", f.message}});
  }
  return list;
}

void append_findings(std::string& out, const char* title, const std::vector<Finding>& findings) {
  for (const Finding& f : findings) {
    out += fmt::format("{}: {}: ", title, f.kind);
    if (!f.first.empty()) out += fmt::format("{} ", f.count);
    out += f.message;
    if (!f.first.empty())
      out += fmt::format(" (at {}{})", fmt::join(f.first, ", "), f.count > f.first.size() ? ", ..." : "");
    out += '\n';
  }
}

std::string counts(const std::map<std::string, std::size_t>& items) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : items) parts.push_back(fmt::format("{} {}", count, name));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

nlohmann::ordered_json pair_json(const PeriodicPair& pair) {
  const auto list = [](const Vec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  nlohmann::ordered_json json = {{"a", pair.a}, {"b", pair.b}, {"translate", list(pair.translate)}};
  if (pair.angle == 0.0) return json;
  json["axis"] = list(pair.axis);
  json["centre"] = list(pair.centre);
  json["angle"] = pair.angle;
  return json;
}

std::string pair_text(const PeriodicPair& pair, std::size_t faces) {
  const auto text = [](const Vec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); };
  std::string out = fmt::format("periodic: {} leads to {}", pair.a, pair.b);
  if (faces > 0) out += fmt::format(", {} faces", faces);
  if (pair.angle != 0.0)
    out += fmt::format(", turned by {:.9g} degrees around {} at {}", pair.angle, text(pair.axis), text(pair.centre));
  if (pair.angle == 0.0 || pair.translate != Vec3{}) out += fmt::format(", moved by {}", text(pair.translate));
  return out + "\n";
}

std::string report_json(const MeshReport& report) {
  nlohmann::ordered_json json = {{"file", report.file},
                                 {"format", report.format},
                                 {"dimension", report.dimension},
                                 {"points", report.points},
                                 {"cells", report.cells},
                                 {"regions", report.regions},
                                 {"parts", report.parts},
                                 {"valid", report.valid()},
                                 {"verdict", verdict_name(report.verdict())},
                                 {"repairs", findings_json(report.repairs)},
                                 {"warnings", findings_json(report.warnings)},
                                 {"defects", findings_json(report.defects)}};
  for (const PeriodicPair& pair : report.periodic) json["periodic"].push_back(pair_json(pair));
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string report_text(const MeshReport& report) {
  std::string out = fmt::format("{}\n", report.file);
  if (!report.format.empty()) out += fmt::format("format: {}\n", report.format);
  if (!report.cells.empty()) {
    out += fmt::format("{} points; {}; {} connected parts{}\n", report.points, counts(report.cells), report.parts,
                       report.surface ? "; a surface in space" : (report.dimension == 2 ? "; a planar mesh (2D)" : ""));
  }
  if (!report.regions.empty()) out += fmt::format("regions: {}\n", counts(report.regions));
  for (const PeriodicPair& pair : report.periodic) out += pair_text(pair);
  append_findings(out, "repaired", report.repairs);
  append_findings(out, "warning", report.warnings);
  append_findings(out, "defect", report.defects);
  return out + fmt::format("verdict: {}\n", verdict_name(report.verdict()));
}

}  // namespace dartcast
