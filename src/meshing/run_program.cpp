// A process of its own for another program. Between fork() and exec the child calls only what is allowed there, since
// other threads may hold locks; all that needs memory is made before.
#include "meshing/run_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <thread>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

constexpr int not_found = 127;  // as shells say it

[[noreturn]] void become(char* const* words, const char* folder, const char* output, rlim_t memory) {
  const int out = ::open(output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int in = ::open("/dev/null", O_RDONLY);
  const rlimit limit = {memory, memory};
  const rlimit no_core = {0, 0};
  const bool ready = out >= 0 && in >= 0 && ::dup2(in, 0) >= 0 && ::dup2(out, 1) >= 0 && ::dup2(out, 2) >= 0 &&
                     ::setpgid(0, 0) == 0 && ::setrlimit(RLIMIT_AS, &limit) == 0 &&
                     ::setrlimit(RLIMIT_CORE, &no_core) == 0 && ::chdir(folder) == 0;
  if (ready) ::execvp(words[0], words);
  ::_exit(ready && errno == ENOENT ? not_found : 126);
}

/// Waits for the child; stops it, and all that it started, when its time is over.
int wait_for(pid_t child, double seconds, bool& in_time) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  auto pause = std::chrono::milliseconds(1);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (in_time && std::chrono::steady_clock::now() > end) {
      in_time = false;
      ::kill(-child, SIGKILL);
      ::kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(20));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Waits until the process that it guards has ended. Then it ends the last program of which it has heard, and removes the
// folder. It is in a group of its own: Ctrl-C is not for it.
[[noreturn]] void guard(int from, const char* folder) {
  ::setpgid(0, 0);
  pid_t program = 0;
  pid_t next = 0;
  while (::read(from, &next, sizeof next) == sizeof next) program = next;
  if (program > 0) ::kill(-program, SIGKILL);
  ::usleep(100'000);  // the program's last file is there
  ::execlp("rm", "rm", "-rf", "--", folder, nullptr);
  ::_exit(126);
}

std::string last_words(const fs::path& output) {
  std::ifstream in(output, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  constexpr std::size_t most = 300;
  if (text.size() > most) text = "... " + text.substr(text.size() - most);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, ' ');
  const auto twice = [](char a, char b) { return a == ' ' && b == ' '; };
  text.erase(std::unique(text.begin(), text.end(), twice), text.end());
  return text;
}

}  // namespace

ProgramEnd run_program(const std::vector<std::string>& words, const TemporaryFolder& folder, double seconds,
                       std::uint64_t memory) {
  std::vector<std::string> own = words;
  std::vector<char*> pointers;
  for (std::string& word : own) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string place = folder.path().string();
  const std::string output = (folder.path() / "output.txt").string();
  const pid_t child = ::fork();
  if (child < 0) throw Error(fmt::format("no process can be made for {}: {}", words[0], std::strerror(errno)));
  if (child == 0) become(pointers.data(), place.c_str(), output.c_str(), static_cast<rlim_t>(memory));
  folder.set_program(child);
  ProgramEnd end;
  end.status = wait_for(child, seconds, end.in_time);
  folder.set_program(0);
  end.found = end.status != not_found;
  end.last_words = last_words(output);
  return end;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "dartcast_mesh_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw Error(fmt::format("{}: no temporary folder can be made: {}", name, std::strerror(errno)));
  path_ = name;
  std::array<int, 2> ends = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return;  // without a guard, then
  guard_ = ::fork();
  if (guard_ == 0) {
    ::close(ends[1]);
    guard(ends[0], name.c_str());
  }
  ::close(ends[0]);
  to_guard_ = ends[1];
}

TemporaryFolder::~TemporaryFolder() {
  if (guard_ > 0) {
    ::kill(guard_, SIGKILL);
    ::waitpid(guard_, nullptr, 0);
  }
  if (to_guard_ >= 0) ::close(to_guard_);
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void TemporaryFolder::set_program(int process) const { ::send(to_guard_, &process, sizeof process, MSG_NOSIGNAL); }

}  // namespace dartcast
