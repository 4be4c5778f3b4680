// The command on a terminal: progress, bold subjects, Ctrl-C. Each test runs it with a pseudo-terminal as its own.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/command.hpp"

namespace {

namespace fs = std::filesystem;

struct Session {
  int status = -1;     // the exit status; -1: ended by a signal
  std::string screen;  // what came to the terminal
};

class Terminal : public dartcast::test::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    vessel = fs::path(scenes_folder) / "vessel.toml";
  }

  // Runs the command. Ctrl-C is pressed when each of `awaited` has been seen, in this order.
  [[nodiscard]] Session run(const std::vector<std::string>& arguments, std::vector<std::string> awaited = {},
                            const std::string& variable = "TERM=xterm") const {
    int terminal = -1;
    winsize size{.ws_row = 24, .ws_col = 100, .ws_xpixel = 0, .ws_ypixel = 0};
    const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
    if (child == 0) {
      std::vector<const char*> words = {binary.c_str()};
      for (const std::string& a : arguments) words.push_back(a.c_str());
      words.push_back(nullptr);
      ::setenv("TERM", "xterm", 1);
      ::unsetenv("NO_COLOR");
      const std::size_t equals = variable.find('=');
      ::setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
      if (::chdir(folder.c_str()) == 0) ::execv(binary.c_str(), const_cast<char* const*>(words.data()));
      ::_exit(127);
    }
    Session session;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::read(terminal, buffer.data(), buffer.size())) > 0;) {
      session.screen.append(buffer.data(), static_cast<std::size_t>(n));
      while (!awaited.empty() && session.screen.find(awaited.front()) != std::string::npos) {
        EXPECT_EQ(::write(terminal, "\x03", 1), 1);
        awaited.erase(awaited.begin());
      }
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(terminal);
    session.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return session;
  }

  [[nodiscard]] nlohmann::json summary(const std::string& run) const {
    std::ifstream file(folder / run / "summary.json");
    return nlohmann::json::parse(std::string(std::istreambuf_iterator<char>(file), {}));
  }

  fs::path vessel;
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(Terminal, ProgressIsShownAndTakenAway) {
  const Session s = run({"run", vessel.string(), "-o", "a", "--steps", "300"});
  EXPECT_EQ(s.status, 0);
  EXPECT_TRUE(has(s.screen, "step 1 of 300"));
  EXPECT_TRUE(has(s.screen, " steps/s"));
  EXPECT_TRUE(has(s.screen, "\r\x1b[K\x1b[1mscene\x1b[0m        vessel: 300 steps")) << s.screen;
}

// A mesher that takes a while: the line says its stage, and since when, and gives way to the error.
TEST_F(Terminal, WhatIsWaitedForIsShownAndTakenAway) {
  std::ofstream(folder / "a.off") << "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const fs::path slept = folder / "slept";  // it is called again where it fails: then it need not wait
  std::ofstream(folder / "tetgen") << "#!/bin/sh\nmkdir '" + slept.string() + "' && sleep 1.5\nexit 1\n";
  fs::permissions(folder / "tetgen", fs::perms::owner_all);
  std::ofstream(folder / "a.toml") << "[environment]\nmesh = { surface = \"a.off\", with = \"tetgen\" }\n";
  const auto screen = [&](const std::vector<std::string>& words) {
    fs::remove(slept);
    return run(words, {}, "PATH=" + folder.string() + ":/usr/bin:/bin").screen;
  };
  const std::vector<std::string> mesh = {"mesh", "a.off", "-o", "a.vtu", "--with", "tetgen"};
  for (const std::vector<std::string>& words : {mesh, {"run", "a.toml", "-o", "a"}}) {
    const std::string text = screen(words);
    EXPECT_TRUE(has(text, "\rmeshing a.off, tetgen fills the surface: 1 s\x1b[K")) << text;
    EXPECT_TRUE(has(text, "\r\x1b[K")) << text;
  }
  EXPECT_FALSE(has(screen({"run", "a.toml", "-o", "a", "-q"}), "meshing"));
}

TEST_F(Terminal, NothingIsBoldWithNoColorAndOnDumbTerminals) {
  for (const char* variable : {"NO_COLOR=1", "TERM=dumb"})
    EXPECT_FALSE(has(run({"run", vessel.string(), "-o", "a", "--steps", "3"}, {}, variable).screen, "\x1b[1m"))
        << variable;
  EXPECT_TRUE(has(run({"run", vessel.string(), "-o", "a", "--steps", "3"}, {}, "NO_COLOR=").screen, "\x1b[1m"));
}

TEST_F(Terminal, JsonAndQuietShowNoProgress) {
  EXPECT_EQ(run({"run", vessel.string(), "-o", "a", "--steps", "30", "--json"}).screen.front(), '{');
  EXPECT_EQ(run({"run", vessel.string(), "-o", "a", "--steps", "30", "-q"}).screen, "");
}

// Ctrl-C ends a run after its step. The command that is printed goes on to the same end as a run that nobody stopped.
TEST_F(Terminal, CtrlCLeavesARunThatGoesOn) {
  const Session s = run({"run", vessel.string(), "-o", "a b", "--steps", "1000000", "--seed", "7"}, {"steps/s"});
  ASSERT_EQ(s.status, 130) << s.screen;
  EXPECT_TRUE(has(s.screen, "dartcast: interrupted after step ")) << s.screen;
  EXPECT_TRUE(has(s.screen, "to go on: dartcast run ")) << s.screen;
  EXPECT_TRUE(has(s.screen, " -o 'a b' --resume --steps 1000000 --seed 7")) << s.screen;
  const std::string steps = std::to_string(summary("a b")["steps"].get<int>() + 20);
  EXPECT_EQ(run({"run", vessel.string(), "-o", "a b", "--resume", "--steps", steps, "--seed", "7"}).status, 0);
  EXPECT_EQ(run({"run", vessel.string(), "-o", "c", "--steps", steps, "--seed", "7"}).status, 0);
  EXPECT_EQ(summary("a b")["state_hash"], summary("c")["state_hash"]);
  EXPECT_EQ(summary("a b")["steps"], summary("c")["steps"]);
}

// Steps of many particles take long enough for a second Ctrl-C.
TEST_F(Terminal, ASecondCtrlCEndsAtOnce) {
  std::ofstream(folder / "many.toml") << "[environment]\ngenerator = \"box\"\n[[particles]]\ncount = 2000000\n"
                                         "velocity = [1.0, 0.5, 0.2]\n[motion]\ndt = 0.3\nsteps = 1000000\n"
                                         "[contact]\nresponse = \"reflect\"\n[output]\nevery = 0\n";
  const Session s = run({"run", "many.toml", "-o", "a"}, {"step 1 ", "ends after this step"});
  EXPECT_EQ(s.status, -1) << s.screen;
}

// Each particle meets 17 walls a step. So one step takes several seconds.
TEST_F(Terminal, ASignalEndsAStepThatTakesLongWithinASecond) {
  std::ofstream(folder / "long.toml") << "[environment]\ngenerator = \"box\"\n[[particles]]\ncount = 200000\n"
                                         "velocity = [1e5, 7e4, 3e4]\n[motion]\ndt = 1.0\nsteps = 10\n"
                                         "[contact]\nresponse = \"reflect\"\n";
  const auto begin = std::chrono::steady_clock::now();
  const auto r =
      run_program("timeout", "--foreground --preserve-status -s TERM 1 '" + binary + "' run long.toml -o a -j 1");
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(r.status, 143) << r.error;
  EXPECT_LT(seconds.count(), 3.0);
  EXPECT_TRUE(has(r.error, "--resume goes on from the last checkpoint")) << r.error;
  EXPECT_TRUE(fs::exists(folder / "a" / "checkpoint.bin"));
}

}  // namespace
