// A page that runs scenes in the browser. Not installed.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace dartcast {

/// The page has the scenes, the files that they name, the engine and the state hashes of native runs. `engine`: a folder with
/// dartcast.mjs and dartcast.wasm of the npm package (./dev wasm). Throws Error if these cannot be read, or a scene names a
/// file that a page cannot hold; else as read_scene(), load_scene_files() and Simulation. Cost: some steps of
/// each scene. Precondition: there is a scene.
std::string live_page(std::span<const std::filesystem::path> scenes, const std::filesystem::path& engine);

}  // namespace dartcast
