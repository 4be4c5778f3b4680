// Writes pieces of memory to files, by the system's calls.
#include "formats/file_write.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path) {
  throw Error(fmt::format("{}: the file cannot be written ({}); check the folder, its permissions and the disk's space",
                          path.string(), std::generic_category().message(errno)));
}

// A file open for writing.
class File {
 public:
  File(const fs::path& path, int flags)
      : path_(path), descriptor_(::open(path.c_str(), O_WRONLY | O_CLOEXEC | flags, 0666)) {
    if (descriptor_ < 0) fail(path_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  void write(std::span<const std::string_view> pieces) {
    while (!pieces.empty()) {
      const std::size_t count = std::min(pieces.size(), calls_.size());
      std::size_t bytes = 0;
      for (std::size_t i = 0; i < count; ++i) {
        calls_[i] = {const_cast<char*>(pieces[i].data()), pieces[i].size()};
        bytes += pieces[i].size();
      }
      write_all({calls_.data(), count}, bytes);
      pieces = pieces.subspan(count);
    }
  }

  void close() {
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) fail(path_);
  }

 private:
  void write_all(std::span<iovec> left, std::size_t bytes) {
    while (bytes > 0) {
      const ssize_t written = ::writev(descriptor_, left.data(), static_cast<int>(left.size()));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail(path_);
      auto done = static_cast<std::size_t>(written);
      bytes -= done;
      for (; !left.empty() && done >= left.front().iov_len; left = left.subspan(1)) done -= left.front().iov_len;
      if (left.empty()) break;
      left.front().iov_base = static_cast<char*>(left.front().iov_base) + done;
      left.front().iov_len -= done;
    }
  }

  const fs::path& path_;
  int descriptor_;
  std::array<iovec, 64> calls_{};
};

}  // namespace

void write_pieces(const fs::path& path, std::span<const std::string_view> pieces) {
  File file(path, O_CREAT | O_TRUNC);
  file.write(pieces);
  file.close();
}

void replace_file(const fs::path& path, std::span<const std::string_view> pieces) {
  const fs::path part = path.string() + std::string(part_ending);
  std::error_code error;
  try {
    write_pieces(part, pieces);
  } catch (const Error&) {
    const int reason = errno;
    fs::remove(part, error);
    errno = reason;
    fail(path);
  }
  if (::rename(part.c_str(), path.c_str()) == 0) return;
  const int reason = errno;
  fs::remove(part, error);
  errno = reason;
  fail(path);
}

void append_bytes(const fs::path& path, std::string_view bytes) {
  File file(path, O_APPEND);
  file.write({&bytes, 1});
  file.close();
}

void write_bytes(const fs::path& path, std::string_view bytes) { write_pieces(path, {&bytes, 1}); }

}  // namespace dartcast
