// The files of a run's folder: tables that can be gone on with, lists of frames, and which names are a run's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace dartcast {

struct RecordingFrame {
  std::uint64_t step = 0;
  double time = 0.0;  ///< s
};

/// Whether a file is one that a run writes: by its name.
bool is_run_file(const std::string& name);

/// The step of a frame's file, by its name; none where it is no frame's.
std::optional<std::uint64_t> frame_step(std::string_view name);

/// "particles", step 10, ".vtp": particles_000010.vtp.
std::string frame_name(std::string_view series, std::uint64_t step, std::string_view ending);

/// A collection for ParaView: a file per frame.
void write_pvd(const std::filesystem::path& path, std::span<const RecordingFrame> frames,
               const std::function<std::string(std::uint64_t step)>& name);

/// A table that steps are added to. Every member throws Error where the file cannot be written.
class RunTable {
 public:
  RunTable() = default;
  /// A new one.
  RunTable(std::filesystem::path path, std::string_view header);
  /// Goes on behind its first `bytes` bytes. Throws Error where it is shorter.
  RunTable(std::filesystem::path path, std::uint64_t bytes);

  [[nodiscard]] bool is_open() const { return file_.is_open(); }
  [[nodiscard]] std::ostream& stream() { return file_; }
  void check();
  /// Sends it to its file; its length then, 0 where there is none.
  std::uint64_t written();
  void close();

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace dartcast
