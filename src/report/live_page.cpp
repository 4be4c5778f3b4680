// Makes the page of a live scene.
//
// Phases: read the scene and the files that it names; run some steps natively, for a state hash to compare with; put scene,
// files, engine and viewer together, compressed.
#include "report/live_page.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
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

// All texts in a scene that name a file, from the scene's folder.
void add_files(const toml::node& node, const fs::path& folder, std::vector<std::string>& files) {
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) add_files(value, folder, files);
  } else if (const toml::array* array = node.as_array()) {
    for (const toml::node& value : *array) add_files(value, folder, files);
  } else if (const auto* text = node.as_string()) {
    const fs::path path = folder / text->get();
    if (fs::is_directory(path) && !text->get().empty() && text->get() != ".")
      throw Error(fmt::format("{}: a live page cannot hold a folder; convert it with dartcast convert", path.string()));
    if (fs::is_regular_file(path) && std::find(files.begin(), files.end(), text->get()) == files.end())
      files.push_back(text->get());
  }
}

// The state hash after some steps, or after all that the scene has.
nlohmann::json native_hash(const Scene& scene) {
  Simulation simulation(load_scene_files(scene).scene);
  const std::uint64_t steps = std::min(compared_steps, scene.motion.steps);
  for (std::uint64_t i = 0; i < steps; ++i) simulation.step();
  return {{"steps", steps}, {"hash", simulation.state_hash().hex()}};
}

}  // namespace

std::string live_page(const fs::path& scene_path, const fs::path& engine) {
  const Scene scene = read_scene(scene_path);
  const toml::table table = toml::parse(scene.text);
  std::vector<std::string> files;
  add_files(table, scene_path.parent_path(), files);
  std::ostringstream keys;
  keys << toml::json_formatter{table};
  nlohmann::json meta = {{"engine", {{"program", 0}, {"wasm", 1}}},
                         {"scene", nlohmann::json::parse(keys.str())},
                         {"native", native_hash(scene)},
                         {"files", nlohmann::json::object()}};
  Page page;
  page.title = scene.name;
  page.subtitle = "A live scene: the engine runs in this page, with the same bits as natively.";
  page.body =
      "<section id=\"view\" aria-label=\"The scene in 3D\"><p class=\"fallback\">A live scene needs JavaScript, WebGL "
      "and "
      "WebAssembly with SIMD.</p></section>\n";
  page.runs_engine = true;
  std::vector<std::string> blocks = {bytes_of_file(engine / "dartcast.mjs"), bytes_of_file(engine / "dartcast.wasm")};
  for (const std::string& file : files) {
    meta["files"][file] = blocks.size();
    blocks.push_back(bytes_of_file(scene_path.parent_path() / file));
  }
  page.scripts.push_back(json_script(meta.dump()));
  for (std::size_t i = 0; i < blocks.size(); ++i)
    page.scripts.push_back(packed_script(fmt::format("b{}", i), blocks[i]));
  page.scripts.push_back(packed_script("viewer", viewer_program()));
  page.scripts.push_back(fmt::format("<script type=\"module\">{}</script>\n", start_program));
  return page_html(page);
}

}  // namespace dartcast
