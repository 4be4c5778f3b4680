// The command's help: overviews, what was meant, completion. Bash's own words say what it would complete.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/command.hpp"

namespace dartcast::help_test {

using test::Result;

class Help : public test::CommandTest {
 protected:
  // The words that bash offers after these; the last one is at the cursor.
  [[nodiscard]] std::vector<std::string> completed(const std::vector<std::string>& words) const {
    std::string list;
    for (const std::string& w : words) list += " \"" + w + "\"";
    const Result r = run_program("bash", "-c 'source <(\"" + binary + "\" completion bash) && COMP_WORDS=(" + list +
                                             ") && COMP_CWORD=" + std::to_string(words.size() - 1) +
                                             " && _dartcast; printf \"%s\\n\" \"${COMPREPLY[@]}\"'");
    EXPECT_EQ(r.error, "");
    return words_of(r.out);
  }

  static std::vector<std::string> words_of(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
  }

  // First words of the lines behind "Subcommands:".
  [[nodiscard]] std::vector<std::string> verbs() const {
    std::istringstream in(run("--help").out);
    std::vector<std::string> found;
    bool is_verb = false;
    for (std::string line; std::getline(in, line);) {
      if (is_verb && line.rfind("   ", 0) != 0 && !words_of(line).empty()) found.push_back(words_of(line).front());
      is_verb = is_verb || line == "Subcommands:";
    }
    return found;
  }

  // All words of a verb's help that start as options do.
  [[nodiscard]] std::set<std::string> options(const std::string& verb) const {
    std::istringstream in(run(verb + " --help").out);
    std::set<std::string> found;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("  -", 0) != 0) continue;
      std::istringstream names(words_of(line).front());
      for (std::string name; std::getline(names, name, ',');) found.insert(name);
    }
    return found;
  }
};

TEST_F(Help, BashCompletesVerbsOptionsAndWords) {
  const std::vector<std::string> all = verbs();
  ASSERT_GE(all.size(), 14U);
  std::vector<std::string> first = completed({"dartcast", ""});
  for (const std::string& verb : all) {
    EXPECT_EQ(std::count(first.begin(), first.end(), verb), 1) << verb;
    const std::vector<std::string> given = completed({"dartcast", verb, "-"});
    EXPECT_EQ(std::set<std::string>(given.begin(), given.end()), options(verb)) << verb;
  }
  EXPECT_EQ(completed({"dartcast", "re"}), (std::vector<std::string>{"report", "replay"}));
  EXPECT_EQ(completed({"dartcast", "run", "--partition", ""}), (std::vector<std::string>{"particles", "cells"}));
  EXPECT_EQ(completed({"dartcast", "run", "a.toml", "--partition", "=", "c"}), std::vector<std::string>{"cells"});
  EXPECT_EQ(completed({"dartcast", "mesh", "a.stl", "--with", "g"}), std::vector<std::string>{"gmsh"});
  EXPECT_EQ(completed({"dartcast", "help", "tr"}), std::vector<std::string>{"trace"});
  EXPECT_EQ(completed({"dartcast", "completion", ""}).front(), "bash");
  EXPECT_TRUE(completed({"dartcast", "run", "sce"}).empty());  // then bash completes files
}

TEST_F(Help, ZshReadsItsScript) {
  if (std::system("zsh -c true 2> /dev/null") != 0) GTEST_SKIP() << "no zsh here";
  (void)write("_dartcast", run("completion zsh").out);
  const Result r = run_program("zsh", "-f -n _dartcast");
  EXPECT_EQ(r.status, 0) << r.error;
  const Result loaded = run_program(
      "zsh", "-fc 'autoload -U compinit && compinit -u -d dump && source ./_dartcast && echo $_comps[dartcast]'");
  EXPECT_EQ(loaded.out, "_dartcast\n") << loaded.error;
}

TEST_F(Help, HelpPrintsTheOverviewAndVerbs) {
  const std::string all = run("--help").out;
  EXPECT_EQ(run("help").out, all);
  for (const std::string& verb : verbs()) {
    EXPECT_EQ(run("help " + verb).out, run(verb + " --help").out);
    expect_failure("", 2, verb);
  }
  expect_failure("help rnu", 2, "did you mean 'run'?");
  EXPECT_EQ(run("-V").out, run("--version").out);
}

TEST_F(Help, AWrongWordNamesTheOneThatIsClose) {
  expect_failure("chekc a.vtu", 2, "'chekc' is no verb (did you mean 'check'?); see dartcast --help");
  expect_failure("fly", 2, "'fly' is no verb; see dartcast --help");
  expect_failure("run a.toml --stpes 5", 2,
                 "dartcast run has no option --stpes (did you mean '--steps'?); see dartcast run --help");
  expect_failure("run a.toml --reusme=1", 2, "(did you mean '--resume'?)");
  expect_failure("run a.toml --fast", 2, "dartcast run has no option --fast; see");
  expect_failure("run a.toml b.toml", 2, "'b.toml' is one argument too many");
  expect_failure("run a.toml --partition cell", 2, "'cell' is none of particles, cells (did you mean 'cells'?)");
  expect_failure("mesh a.stl -o a.vtu --with netgen", 2, "'netgen' is none of tetgen, gmsh");
  expect_failure("plan a.vtu --ranks 4 --step 2", 2, "--step: '2' is no number from 0 to 1");
}

TEST_F(Help, AWrongKeyOfASceneNamesTheOneThatIsClose) {
  const std::string box = "[environment]\ngenerator = 'box'\n";
  (void)write("a.toml", box + "[motion]\ngravty = [0, 0, 0]\n");
  expect_failure("run a.toml", 1, "the key 'gravty' is unknown (did you mean 'gravity'?); there are ");
  (void)write("b.toml", box + "[contacts]\n");
  expect_failure("run b.toml", 1, "the key 'contacts' is unknown (did you mean 'contact'?)");
  (void)write("c.toml", "seed = 1\n[enviroment]\ngenerator = 'box'\n");
  expect_failure("run c.toml", 1, "c.toml:2: the key 'enviroment' is unknown (did you mean 'environment'?)");
  (void)write("c.toml", box + "[contact]\nresponse = 'reflekt'\n");
  expect_failure("run c.toml", 1, "it must be one of reflect, slide, stick, absorb, escape (did you mean 'reflect'?)");
}

// The bar is 28 m long in cells of 1 m. In other units it is too long or too short; and too fast in any.
TEST_F(Help, TheTableShowsTheScaleAndWarns) {
  const auto table = [&](const std::string& scale, const std::string& speed) {
    (void)write("bar.toml", "[environment]\nmesh = 'bar.vtu'\n" + scale +
                                "[[particles]]\ncount = 10\nvelocity = [0, 0, " + speed +
                                "]\n[motion]\ndt = 1.0\nsteps = 2\n[output]\nevery = 1\n");
    return run("run bar.toml -o out").out;
  };
  (void)write("make.toml", "[environment]\ngenerator = 'bar'\n[motion]\nsteps = 1\n");
  ASSERT_EQ(run("run make.toml -o made").status, 0);
  std::filesystem::copy_file(folder / "made/environment.vtu", folder / "bar.vtu");
  const std::string plain = table("", "99.0");
  EXPECT_NE(plain.find("from (0, 0, 0) to (5, 5, 28) m   edges of cells: smallest 1 m, mean 1 m\n"), std::string::npos)
      << plain;
  EXPECT_EQ(plain.find("warning"), std::string::npos) << plain;
  const std::string fast = table("", "101.0");
  EXPECT_NE(fast.find("warning: 20 steps of particles were longer than 100 cells"), std::string::npos) << fast;
  const std::string large = table("scale = 40.0\n", "1.0");
  EXPECT_NE(large.find("warning: the mesh is 1.12e+03 m across"), std::string::npos) << large;
  const std::string small = table("scale = 3e-7\n", "1e-7");
  EXPECT_NE(small.find("warning: the mesh is 8.4e-06 m across"), std::string::npos) << small;
}

}  // namespace dartcast::help_test
