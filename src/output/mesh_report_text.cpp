// The report on a mesh file, for people.
#include "output/mesh_report_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
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

std::string report_json(const MeshReport& report) {
  const nlohmann::ordered_json json = {{"file", report.file},
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
  append_findings(out, "repaired", report.repairs);
  append_findings(out, "warning", report.warnings);
  append_findings(out, "defect", report.defects);
  return out + fmt::format("verdict: {}\n", verdict_name(report.verdict()));
}

}  // namespace dartcast
