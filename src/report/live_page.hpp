// A page that runs a scene in the browser. Not installed.
#pragma once

#include <filesystem>
#include <string>

namespace dartcast {

/// The page has the scene, the files that it names, the engine and the state hash of a native run. `engine`: a folder with
/// dartcast.mjs and dartcast.wasm of the npm package (./dev wasm). Throws Error if these cannot be read, or the scene names a
/// file that a page cannot hold; else as read_scene(), load_scene_files() and Simulation. Cost: some steps of the scene.
std::string live_page(const std::filesystem::path& scene, const std::filesystem::path& engine);

}  // namespace dartcast
