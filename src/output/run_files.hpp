// The files of a run's folder: tables that can be gone on with, lists of frames, and which names are a run's.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "output/writing_thread.hpp"

namespace dartcast {

struct RecordingFrame {
  std::uint64_t step = 0;
  double time = 0.0;                     ///< s
  std::uint32_t pieces = 1;              ///< files of particles: one of each rank
  std::uint32_t environment_pieces = 1;  ///< of the environment, if it is spread
};

/// The mesh that was made around a scene's surfaces. A run that starts anew leaves it where it is.
inline constexpr std::string_view kept_mesh_name = "surface_mesh.msh";

/// The step that the audit or the library found wrong, to be taken again (dartcast/replay.hpp).
inline constexpr std::string_view replay_name = "replay.json";

/// Whether a file is one that a run writes, or began to write and did not end: by its name.
bool is_run_file(std::string_view name);

/// The step of a frame's file, by its name; none if it is no frame's.
std::optional<std::uint64_t> frame_step(std::string_view name);

/// Where a rank but the first leaves its part of a checkpoint: checkpoint_000010.2.bin.
std::string checkpoint_part_name(std::uint64_t step, unsigned rank);

/// The step of such a part, by its name; none if it is none.
std::optional<std::uint64_t> checkpoint_part_step(std::string_view name);

/// Piece 2 of the series "particles" at step 10, ".vtp": particles_000010.2.vtp.
std::string piece_name(std::string_view series, std::uint64_t step, unsigned piece, std::string_view ending);

/// "particles", step 10, ".vtp": particles_000010.vtp.
std::string frame_name(std::string_view series, std::uint64_t step, std::string_view ending);

/// Whether a file is one that a run began to write and did not end.
bool is_part_of_run_file(std::string_view name);

/// A collection for ParaView, in place of the one before: a file per frame.
void write_pvd(const std::filesystem::path& path, std::span<const RecordingFrame> frames,
               const std::function<std::string(const RecordingFrame&)>& name);

/// Takes the frames of other steps than `kept` out of a list.
void keep_in_pvd(const std::filesystem::path& path, const std::set<std::uint64_t>& kept);

/// A table that rows are added to in memory, and which a thread writes.
class RunTable {
 public:
  RunTable() = default;
  /// A new file, at once. Throws Error if it cannot be written.
  RunTable(std::filesystem::path path, std::string_view header);
  /// Goes on behind its first `bytes` bytes. Throws Error if it is shorter.
  RunTable(std::filesystem::path path, std::uint64_t bytes);

  [[nodiscard]] bool is_open() const { return !path_.empty(); }
  template <class... Values>
  void print(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(rows_), form, std::forward<Values>(values)...);
  }
  void append(std::string_view bytes) { rows_ += bytes; }
  /// Leaves the rows to the thread. Returns the file's length when all that were sent are in it; 0 if there is no
  /// table.
  std::uint64_t send(WritingThread& writing);
  /// The same, if they are many.
  void send_many(WritingThread& writing);

 private:
  std::filesystem::path path_;
  std::string rows_;
  std::uint64_t bytes_ = 0;
};

}  // namespace dartcast
