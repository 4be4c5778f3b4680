// Locks a run's folder, so that no two runs write to it.
#include "output/run_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// Whether the file of that name is the one that is open: the run before may have removed it in between.
bool is_open_file(const std::filesystem::path& path, int descriptor) {
  struct stat named {};
  struct stat opened {};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(descriptor, &opened) == 0 && named.st_ino == opened.st_ino &&
         named.st_dev == opened.st_dev;
}

[[noreturn]] void refuse_second(const std::filesystem::path& file) {
  std::string holder;
  std::ifstream in(file);
  std::getline(in, holder);
  throw Error(fmt::format("{}: another run writes to this folder (process {}); wait for it, or name another with -o",
                          file.parent_path().string(), holder.empty() ? "unknown" : holder));
}

}  // namespace

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  ::unlink(file_.c_str());  // while it is still locked
  ::close(descriptor_);
}

void RunLock::take(const std::filesystem::path& folder) {
  if (descriptor_ >= 0) return;
  const std::filesystem::path file = folder / run_lock_name;
  while (true) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0)
      throw Error(fmt::format("{}: the file cannot be written: {}", file.string(), std::strerror(errno)));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor);
      refuse_second(file);
    }
    if (!is_open_file(file, descriptor)) {
      ::close(descriptor);
      continue;
    }
    file_ = file;
    descriptor_ = descriptor;
    break;
  }
  const std::string process = fmt::format("{}\n", ::getpid());
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::write(descriptor_, process.data(), process.size()) != static_cast<ssize_t>(process.size()))
    throw Error(fmt::format("{}: the file cannot be written: {}", file.string(), std::strerror(errno)));
}

}  // namespace dartcast
