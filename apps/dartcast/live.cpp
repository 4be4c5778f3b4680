// The verb live: a page that runs scenes in the browser.
//
// Phases: find the engine, which ./dev wasm makes and an installed command has beside it; make the page; write it.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "dartcast/error.hpp"
#include "formats/file_write.hpp"
#include "report/live_page.hpp"

namespace dartcast::app {

namespace {

namespace fs = std::filesystem;

struct LiveArguments {
  std::vector<fs::path> scenes;
  std::string page;
  std::string engine;
};

// Beside an installed command, or in the folder of builds of one that was not.
fs::path engine_folder() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  const std::array folders = {program / "../share/dartcast", program / "../../wasm/package"};
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / "dartcast.wasm")) return folder.lexically_normal();
  }
  throw Error(
      fmt::format("live: there is no engine for browsers in {}; make it with ./dev wasm in dartcast's sources, "
                  "or name its folder with --engine",
                  folders[0].lexically_normal().string()));
}

int live(const LiveArguments& a) {
  const std::string page = live_page(a.scenes, a.engine.empty() ? engine_folder() : fs::path(a.engine));
  const fs::path file = a.page.empty() ? a.scenes.front().stem() += ".html" : fs::path(a.page);
  const std::string_view whole = page;
  replace_file(file, {&whole, 1});
  fmt::print("{}: {:.1f} MB\n", file.string(), static_cast<double>(page.size()) / 1e6);
  return done;
}

}  // namespace

void add_live(CLI::App& app, int& status) {
  const auto a = std::make_shared<LiveArguments>();
  CLI::App* verb = app.add_subcommand("live", "Make a page that runs scenes in the browser, under your hand.");
  verb->add_option("SCENE", a->scenes, "scenes in TOML; the page opens with the first")->required()->type_name("FILE");
  verb->add_option("-o,--output", a->page, "the page (the first scene's name with .html)")->type_name("FILE");
  verb->add_option("--engine", a->engine, "the folder of the engine for browsers (that of the installed command)")
      ->type_name("FOLDER");
  verb->callback([a, &status] { status = live(*a); });
}

}  // namespace dartcast::app
