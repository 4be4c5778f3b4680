// Makes the page of a live scene.
//
// Phases: read the scenes and the files that they name; run some steps of each natively, for a state hash to compare with; put
// scenes, files, engine and viewer together, compressed.
#include "report/live_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "dartcast/error.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "report/encode.hpp"
#include "report/page.hpp"
#include "report/viewer_page.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t compared_steps = 100;  // of the native run

// A program of the page that unpacks the viewer and starts it.
constexpr const char* start_program = R"js(
const packed = Uint8Array.from(atob(document.getElementById('viewer').textContent), (c) => c.charCodeAt(0));
const program = document.createElement('script');
program.type = 'module';
program.textContent = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
document.body.append(program);
)js";

std::string bytes_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!(file && bytes << file.rdbuf())) throw Error(fmt::format("{}: the file cannot be read", path.string()));
  return bytes.str();
}

std::string packed_script(const std::string& id, const std::string& bytes) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, base64(gzipped(bytes)));
}

// Texts in a scene that name a file, from the scene's folder.
std::vector<std::string> files_in(const std::string& text, const fs::path& folder) {
  static const std::regex quoted("\"([^\"\n]+)\"|'([^'\n]+)'");
  std::vector<std::string> files;
  for (std::sregex_iterator match(text.begin(), text.end(), quoted), end; match != end; ++match) {
    const std::string name = (*match)[1].matched ? (*match)[1] : (*match)[2];
    if (fs::is_regular_file(folder / name) && std::find(files.begin(), files.end(), name) == files.end())
      files.push_back(name);
  }
  return files;
}

// The state hash after some steps, or after all that the scene has.
nlohmann::json native_hash(const Scene& scene) {
  Simulation simulation(load_scene_files(scene).scene);
  const std::uint64_t steps = std::min(compared_steps, scene.motion.steps);
  for (std::uint64_t i = 0; i < steps; ++i) simulation.step();
  return {{"steps", steps}, {"hash", simulation.state_hash().hex()}};
}

// The scene's part of what the page reads. Its files become blocks.
nlohmann::json scene_meta(const fs::path& path, std::vector<std::string>& blocks) {
  const Scene scene = read_scene(path);
  if (const auto* mesh = std::get_if<fs::path>(&scene.environment.mesh); mesh != nullptr && fs::is_directory(*mesh))
    throw Error(fmt::format("{}: a live page cannot hold a folder; convert it with dartcast convert", mesh->string()));
  const Vec3& g = scene.motion.gravity;
  nlohmann::json meta = {{"name", scene.name},
                         {"scene", scene.text},
                         {"gravity", {g.x, g.y, g.z}},
                         {"native", native_hash(scene)},
                         {"files", nlohmann::json::object()}};
  for (const std::string& file : files_in(scene.text, path.parent_path())) {
    meta["files"][file] = blocks.size();
    blocks.push_back(bytes_of_file(path.parent_path() / file));
  }
  return meta;
}

}  // namespace

std::string live_page(std::span<const fs::path> scenes, const fs::path& engine) {
  std::vector<std::string> blocks = {bytes_of_file(engine / "dartcast.mjs"), bytes_of_file(engine / "dartcast.wasm")};
  nlohmann::json meta = {{"engine", {{"program", 0}, {"wasm", 1}}}, {"scenes", nlohmann::json::array()}};
  for (const fs::path& scene : scenes) meta["scenes"].push_back(scene_meta(scene, blocks));
  Page page;
  page.title = scenes.front().stem().string();
  page.subtitle = "A live scene: the engine runs in this page, with the same bits as natively.";
  page.body =
      "<section id=\"view\" aria-label=\"The scene in 3D\"><p class=\"fallback\">A live scene needs JavaScript, WebGL "
      "and WebAssembly with SIMD.</p></section>\n";
  page.runs_engine = true;
  page.scripts.push_back(json_script(meta.dump()));
  for (std::size_t i = 0; i < blocks.size(); ++i)
    page.scripts.push_back(packed_script(fmt::format("b{}", i), blocks[i]));
  page.scripts.push_back(packed_script("viewer", viewer_program()));
  page.scripts.push_back(fmt::format("<script type=\"module\">{}</script>\n", start_program));
  return page_html(page);
}

}  // namespace dartcast
