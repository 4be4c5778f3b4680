// Replays of steps that went wrong: in files, and taken again.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step_replay.hpp"

namespace dartcast {

/// The outcome of a step that is taken again, alone among the cells of its replay.
struct ReplayResult {
  std::string wrong;     ///< in words; empty: nothing is
  ParticleState state;   ///< after the step
  ContactList contacts;  ///< of the step
  bool cut = false;      ///< it has met a face behind which the replay has no cells: the end is not that in the scene
};

/// Takes the step again in an environment of the replay's cells: by a batch of equal particles, in rounds and by trace().
/// Results must be the same bits, the end must pass the audit and lie in the chamber where the step started. Throws
/// InvalidMesh if the cells make no environment, and InvalidArgument if the state does not fit them. Cost: that of
/// an Environment.
ReplayResult replay(const StepReplay& step);

/// A replay as JSON. Numbers keep their bits; those that are not finite are text.
std::string replay_text(const StepReplay& step);
/// The replay of such a text. Throws Error, which says where the text is wrong.
StepReplay replay_of_text(std::string_view text);

/// Writes replay_text() to a file. Throws Error with the file's name.
void write_replay(const StepReplay& step, const std::filesystem::path& file);
/// Reads such a file. Throws Error with its name.
StepReplay read_replay(const std::filesystem::path& file);

}  // namespace dartcast
