// The command, as a user runs it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace dartcast::test {

/// The outcome of a command.
struct Result {
  int status = -1;
  std::string out;
  std::string error;
};

/// Runs the command in a folder of its own.
class CommandTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* path = std::getenv("DARTCAST_BINARY");
    const char* scenes = std::getenv("DARTCAST_SCENES");
    ASSERT_TRUE(path != nullptr && scenes != nullptr) << "run this through ctest";
    binary = path;
    scenes_folder = scenes;
    folder = std::filesystem::temp_directory_path() / ("dartcast_command_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  static std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }

  // Runs the command in the test's folder.
  [[nodiscard]] Result run(const std::string& arguments) const { return run_program(binary, arguments); }
  [[nodiscard]] Result run_program(const std::string& program, const std::string& arguments) const {
    Result result;
    const std::string line = "cd '" + folder.string() + "' && '" + program + "' " + arguments + " 2> error.txt";
    FILE* pipe = popen(line.c_str(), "r");
    std::array<char, 4096> buffer{};
    for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      result.out.append(buffer.data(), n);
    const int status = pclose(pipe);
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.error = content(folder / "error.txt");
    return result;
  }

  // One clear line on stderr, nothing on stdout.
  void expect_failure(const std::string& arguments, int status, const std::string& part) const {
    const Result r = run(arguments);
    EXPECT_EQ(r.status, status) << arguments << "\n" << r.error;
    EXPECT_EQ(r.out, "") << arguments;
    EXPECT_EQ(std::count(r.error.begin(), r.error.end(), '\n'), 1) << arguments << "\n" << r.error;
    EXPECT_EQ(r.error.rfind("dartcast: ", 0), 0U) << r.error;
    EXPECT_NE(r.error.find(part), std::string::npos) << arguments << "\n" << r.error;
  }

  [[nodiscard]] std::string scene(const std::string& name) const {
    return "'" + (std::filesystem::path(scenes_folder) / name).string() + "'";
  }

  // A tetrahedron, as Medit text.
  [[nodiscard]] static std::string tetrahedron(const std::string& corners = "1 2 3 4") {
    return "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n" +
           corners + " 5\nEnd\n";
  }

  std::string binary;
  std::string scenes_folder;
  std::filesystem::path folder;
};

}  // namespace dartcast::test
