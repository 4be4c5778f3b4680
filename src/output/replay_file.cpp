// Replays of steps as JSON.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/replay.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"

namespace dartcast {

namespace {

using ReplayJson = nlohmann::ordered_json;

constexpr const char* replay_kind = "dartcast replay 1";

ReplayJson number_json(double x) {
  if (std::isfinite(x)) return x;
  return std::isnan(x) ? "nan" : x > 0.0 ? "inf" : "-inf";
}
double number_of(const ReplayJson& json) {
  if (json.is_number()) return json.get<double>();
  const std::string text = json.get<std::string>();
  if (text == "inf") return std::numeric_limits<double>::infinity();
  if (text == "-inf") return -std::numeric_limits<double>::infinity();
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  throw Error(fmt::format("'{}' is no number", text));
}

ReplayJson point_json(const Vec3& p) { return {number_json(p.x), number_json(p.y), number_json(p.z)}; }
Vec3 point_of(const ReplayJson& json) { return {number_of(json.at(0)), number_of(json.at(1)), number_of(json.at(2))}; }

ReplayJson points_json(const std::vector<Vec3>& list) {
  ReplayJson json = ReplayJson::array();
  for (const Vec3& p : list) json.push_back(point_json(p));
  return json;
}
std::vector<Vec3> points_of(const ReplayJson& json) {
  std::vector<Vec3> list;
  for (const ReplayJson& p : json) list.push_back(point_of(p));
  return list;
}

ReplayJson cells_json(const MeshData& mesh) {
  ReplayJson json = ReplayJson::array();
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    json.push_back({{"type", cell_type_names[static_cast<std::size_t>(mesh.types[c])]},
                    {"free", mesh.free.empty() || mesh.free[c] != 0},
                    {"points", mesh.cell(c)}});
  return json;
}
CellType type_of(const std::string& name) {
  for (std::size_t t = 0; t < cell_type_names.size(); ++t)
    if (cell_type_names[t] == name) return static_cast<CellType>(t);
  throw Error(fmt::format("there is no type of cell '{}'", name));
}

ReplayJson faces_json(const MeshData& mesh) {
  ReplayJson json = ReplayJson::array();
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto name = mesh.patch_names.find(mesh.patch_tags[f]);
    const bool is_cut = name != mesh.patch_names.end() && name->second == StepReplay::cut_patch;
    json.push_back({{"patch", is_cut ? StepReplay::cut_patch : "wall"}, {"points", mesh.patch_face(f)}});
  }
  return json;
}

MeshData mesh_of(const ReplayJson& json) {
  MeshData mesh;
  mesh.points = points_of(json.at("points"));
  for (const ReplayJson& c : json.at("cells")) {
    mesh.add_cell(type_of(c.at("type")), c.at("points").get<std::vector<std::uint32_t>>());
    mesh.free.push_back(c.at("free").get<bool>() ? 1 : 0);
  }
  mesh.patch_names = {{1, "wall"}, {2, StepReplay::cut_patch}};
  mesh.baffle_tags = {1};
  for (const ReplayJson& f : json.at("faces"))
    mesh.add_patch_face(f.at("points").get<std::vector<std::uint32_t>>(),
                        f.at("patch").get<std::string>() == StepReplay::cut_patch ? 2 : 1);
  return mesh;
}

ReplayJson state_json(const ParticleState& s, const Weights& weights) {
  ReplayJson touching = ReplayJson::array();
  for (unsigned i = 0; i < s.touching_count; ++i) touching.push_back({s.touching[i].cell.value, s.touching[i].face});
  ReplayJson json = {
      {"position", point_json(s.position)}, {"cell", s.cell.value}, {"simplex", s.simplex}, {"touching", touching}};
  if (s.held) json["held"] = weights;
  return json;
}
ParticleState state_of(const ReplayJson& json, Weights& weights) {
  ParticleState s;
  s.put({Cell{json.at("cell").get<std::uint32_t>()}, json.at("simplex").get<std::uint16_t>()},
        point_of(json.at("position")));
  for (const ReplayJson& t : json.at("touching"))
    s.touching.at(s.touching_count++) = {Cell{t.at(0).get<std::uint32_t>()}, t.at(1).get<std::uint16_t>()};
  s.held = json.contains("held");
  if (s.held) weights = json.at("held").get<Weights>();
  return s;
}

StepReplay step_of(const ReplayJson& json) {
  if (json.at("kind") != replay_kind) throw Error(fmt::format("it is not a '{}'", replay_kind));
  StepReplay step;
  step.reason = json.at("reason");
  step.mesh = mesh_of(json);
  step.moved = points_of(json.at("moved"));
  step.simultaneous = json.at("motion") == "simultaneous";
  step.state = state_of(json.at("particle"), step.weights);
  step.target = point_of(json.at("target"));
  const ReplayJson& options = json.at("options");
  step.options = {options.at("max_contacts"), options.at("tolerance"), options.at("max_slices")};
  step.responds = json.contains("answers");
  if (step.responds)
    for (const ReplayJson& a : json.at("answers"))
      step.answers.push_back({point_of(a.at("displacement")), a.at("along").get<bool>()});
  if (json.contains("end")) step.end = point_of(json.at("end"));
  return step;
}

}  // namespace

std::string replay_text(const StepReplay& step) {
  ReplayJson json = {{"kind", replay_kind},
                     {"reason", step.reason},
                     {"motion", step.simultaneous ? "simultaneous" : "carried"},
                     {"particle", state_json(step.state, step.weights)},
                     {"target", point_json(step.target)},
                     {"options",
                      {{"max_contacts", step.options.max_contacts},
                       {"tolerance", step.options.tolerance},
                       {"max_slices", step.options.max_slices}}}};
  if (step.end) json["end"] = point_json(*step.end);
  if (step.responds) {
    json["answers"] = ReplayJson::array();
    for (const AfterContact& a : step.answers)
      json["answers"].push_back({{"displacement", point_json(a.displacement)}, {"along", a.along}});
  }
  json["points"] = points_json(step.mesh.points);
  json["moved"] = points_json(step.moved);
  json["cells"] = cells_json(step.mesh);
  json["faces"] = faces_json(step.mesh);
  // A line for each entry of the lists, so that people can read it.
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += fmt::format("{}\"{}\": ", text.empty() ? "{" : ",\n ", key);
    if (!value.is_array() || value.empty()) {
      text += value.dump();
      continue;
    }
    const char* separator = "[\n  ";
    for (const ReplayJson& entry : value) {
      text += separator + entry.dump();
      separator = ",\n  ";
    }
    text += "]";
  }
  return text + "}\n";
}

StepReplay replay_of_text(std::string_view text) {
  try {
    return step_of(ReplayJson::parse(text));
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("this is no replay: {}", e.what()));
  } catch (const std::out_of_range&) {
    throw Error("this is no replay: a particle touches at most 3 walls");
  }
}

void write_replay(const StepReplay& step, const std::filesystem::path& file) {
  const std::string text = replay_text(step);
  const std::string_view piece = text;
  replace_file(file, {&piece, 1});
}

StepReplay read_replay(const std::filesystem::path& file) {
  try {
    return replay_of_text(read_bytes(file));
  } catch (const Error& e) {
    throw Error(fmt::format("{}: {}", file.string(), e.what()));
  }
}

}  // namespace dartcast
