// Runs a program's callbacks, and turns what they throw into one line and an exit status.
#include "program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "base/closest_word.hpp"

namespace dartcast::app {

namespace {

// Errors are one line: the lines of a library's message are joined.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

// The verb that was given; the program itself where there is none.
const CLI::App& chosen(const CLI::App& app) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? app : *verbs.front();
}

std::string name_of(const CLI::App& app) {
  const CLI::App& verb = chosen(app);
  return &verb == &app ? app.get_name() : app.get_name() + " " + verb.get_name();
}

// An argument that nothing takes. Options come first: what else is left may be their values.
std::string unexpected(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word.front() == '-'; };
  const auto option = std::find_if(rest.begin(), rest.end(), is_option);
  const CLI::App& given = chosen(app);
  std::vector<std::string> known;
  if (option != rest.end()) {
    const std::string name = option->substr(0, option->find('='));
    for (const CLI::Option* o : given.get_options()) {
      for (const std::string& n : o->get_lnames()) known.push_back("--" + n);
    }
    return fmt::format("{} has no option {}{}", name_of(app), name, did_you_mean(name, known));
  }
  const std::vector<std::string> verbs = verbs_of(app);
  if (&given != &app || verbs.empty()) return fmt::format("'{}' is one argument too many", rest.front());
  return fmt::format("'{}' is no verb{}", rest.front(), did_you_mean(rest.front(), verbs));
}

struct Outcome {
  int status = done;
  std::string error;  // empty: none, or said already
};

Outcome parse(CLI::App& app, int argc, char** argv, const int& status) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return {app.exit(e), ""};  // help, version
  } catch (const CLI::ParseError& e) {
    const bool has_extras = dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr;
    return {wrong_usage, fmt::format("{}; see {} --help", has_extras ? unexpected(app) : e.what(), name_of(app))};
  } catch (const std::bad_alloc&) {
    return {failed, "there is not enough memory for this"};
  } catch (const std::exception& e) {
    return {failed, e.what()};
  }
  return {status, ""};
}

// Printed text may still wait in a buffer. A full disk, or a closed pipe, shows only when it is sent.
bool send_output() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good(); }

}  // namespace

std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return names;
}

int run_program(CLI::App& app, int argc, char** argv, const int& status) {
  Outcome outcome = parse(app, argc, argv, status);
  if (!send_output() && outcome.error.empty())
    outcome = {failed, "the output cannot be written to stdout; check the disk's space"};
  if (!outcome.error.empty()) fmt::print(stderr, "{}: {}\n", app.get_name(), one_line(outcome.error));
  return outcome.status;
}

}  // namespace dartcast::app
