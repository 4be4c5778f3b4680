// The verbs of files: check, info, convert and lagrangian.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "commands.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/format_table.hpp"
#include "max_memory.hpp"
#include "output/export_run.hpp"
#include "output/info.hpp"
#include "output/mesh_report_text.hpp"
#include "scene/scene_mesh.hpp"
#include "terminal.hpp"

namespace dartcast::app {

namespace {

int check(const std::string& mesh, bool skip_bad_cells, bool json, const ReadOptions& options) {
  const MeshReport report = while_waiting("checking " + mesh, !json, options, [&](const ReadOptions& read) {
    return check_mesh(mesh, {}, read, skip_bad_cells).report;
  });
  fmt::print("{}{}", json ? report_json(report) : report_text(report), json ? "\n" : "");
  return report.valid() ? done : failed;
}

// A surface has no cells for particles: the answer says what makes some.
int info_of_surface(const std::string& path, bool json, const ReadOptions& options) {
  const MeshReport report = check_mesh(path, {}, options).report;
  fmt::print("{}{}", json ? report_json(report) : report_text(report), json ? "\n" : "");
  const bool is_read = report.valid() || report.defects.front().kind != "file";
  if (!json && is_read)
    fmt::print(
        "a surface; to move particles inside it: dartcast mesh {0} -o NAME.vtu, or in a scene mesh = {{ surface = "
        "\"{0}\" }}; as a body or solid: surface = \"{0}\"\n",
        path);
  return is_read ? done : failed;
}

int info(const std::string& path, bool json, const ReadOptions& options) {
  if (is_surface_file(path)) return info_of_surface(path, json, options);
  EnvironmentScene scene;
  scene.mesh = std::filesystem::path(path);
  if (std::filesystem::path(path).extension() == ".toml") scene = read_scene(path).environment;
  scene.linearise = scene.linearise || options.linearise;
  const MeshInfo result = while_waiting("loading " + path, !json, options, [&](const ReadOptions& read) {
    return with_mesh_name(scene.mesh, [&] {
      SceneMesh loaded = load_scene_mesh(scene, read);
      MeshInfo of_mesh = mesh_info(loaded.mesh, path);
      of_mesh.warnings = std::move(loaded.warnings);
      return of_mesh;
    });
  });
  fmt::print("{}{}", json ? info_json(result) : info_text(result), json ? "\n" : "");
  return done;
}

int convert(const std::string& in, const std::string& out, const ReadOptions& options) {
  if (std::filesystem::is_regular_file(std::filesystem::path(in) / "particles.pvd")) {
    fmt::print("{} frames in {}\n", export_run(in, out), out);
    return done;
  }
  const auto read = [&](const ReadOptions& o) {
    return is_surface_file(in) ? read_surface(in, o) : read_valid_mesh(in, o);
  };
  write_noting_loss(while_waiting("loading " + in, true, options, read).mesh, out);
  return done;
}

void add_read_options(CLI::App& verb, ReadOptions& options) {
  verb.add_flag("--linearise", options.linearise, "take the corners of cells of second order");
  add_max_memory(verb, options.max_memory);
}

}  // namespace

void write_noting_loss(const MeshData& mesh, const std::string& file) {
  write_mesh(mesh, file);
  if (!mesh.free.empty() && (is_surface_file(file) || !mesh_format_of(file)->arrays))
    fmt::print(stderr,
               "dartcast: {}: this format has no place for which cells are free: give scenes the key free, or write "
               ".vtu\n",
               file);
}

void add_check(CLI::App& app, int& status) {
  const auto mesh = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  CLI::App* verb = app.add_subcommand("check", "Say what is in a mesh file, and whether it is valid.");
  verb->add_option("MESH", *mesh,
                   fmt::format("a mesh: {}, or the folder of an OpenFOAM case; or a surface: {}",
                               fmt::join(mesh_endings(), " "), fmt::join(surface_endings(), " ")))
      ->type_name("FILE")
      ->required();
  const auto skip = std::make_shared<bool>(false);
  verb->add_flag("--skip-bad-cells", *skip, "with this option of dartcast run: bad cells are left out, and a warning");
  verb->add_flag("--json", *json, "print one JSON object, and nothing else");
  const auto options = std::make_shared<ReadOptions>();
  add_read_options(*verb, *options);
  verb->callback([mesh, skip, json, options, &status] { status = check(*mesh, *skip, *json, *options); });
}

void add_info(CLI::App& app, int& status) {
  const auto path = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  CLI::App* verb = app.add_subcommand("info", "Print counts, bounds, shapes and memory.");
  verb->add_option("MESH_OR_SCENE", *path, "a mesh or surface file, or a scene (.toml)")->required()->type_name("FILE");
  verb->add_flag("--json", *json, "print one JSON object, and nothing else");
  const auto options = std::make_shared<ReadOptions>();
  add_read_options(*verb, *options);
  verb->callback([path, json, options, &status] { status = info(*path, *json, *options); });
}

void add_convert(CLI::App& app, int& status) {
  const auto in = std::make_shared<std::string>();
  const auto out = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("convert", "Write a mesh or a run in another format, given by the ending.");
  verb->add_option("IN", *in, "the mesh or surface to read, in any format that check takes; or the folder of a run")
      ->required()
      ->type_name("FILE");
  verb->add_option("OUT,-o,--output", *out,
                   fmt::format("the file to write: {}; a surface also as {}; a run as {}",
                               fmt::join(writable_mesh_endings(), " "), fmt::join(surface_endings(), " "),
                               fmt::join(export_endings(), " ")))
      ->type_name("FILE")
      ->required();
  const auto options = std::make_shared<ReadOptions>();
  add_read_options(*verb, *options);
  verb->callback([in, out, options, &status] { status = convert(*in, *out, *options); });
}

void add_lagrangian(CLI::App& app, int& status) {
  const auto run = std::make_shared<std::string>();
  const auto target = std::make_shared<std::string>();
  const auto cloud = std::make_shared<std::string>("particles");
  CLI::App* verb = app.add_subcommand("lagrangian", "Write a run's particles into an OpenFOAM case.");
  verb->add_option("RUN", *run, "the folder of a run in the case's mesh")->required()->type_name("FOLDER");
  verb->add_option("CASE", *target, "the case: frames go to its folders TIME")->required()->type_name("FOLDER");
  verb->add_option("--cloud", *cloud, "the name of the cloud")->type_name("NAME")->capture_default_str();
  const auto sources = std::make_shared<bool>(false);
  verb->add_flag("--sources", *sources, "also write momentum_source and energy_source as volume fields");
  verb->callback([run, target, cloud, sources, &status] {
    if (*sources) fmt::print("{} frames in {}/*/*_source\n", write_sources(*run, *target), *target);
    fmt::print("{} frames in {}/*/lagrangian/{}\n", write_lagrangian(*run, *target, *cloud), *target, *cloud);
    status = done;
  });
}

}  // namespace dartcast::app
