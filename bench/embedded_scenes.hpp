// Scene files that the command carries in itself, so that it needs none where it is installed.
#pragma once

namespace dartcast::bench {

extern const char* const vessel_scene;   ///< scenes/vessel.toml, the demo
extern const char* const latency_scene;  ///< bench/latency.toml

}  // namespace dartcast::bench
