#include <fmt/format.h>

#include <exception>
#include <string>

#include "commands.hpp"
#include "dartcast/io/summary.hpp"

namespace {

// Errors are one line: what a library below puts on more is joined.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

int complain(int status, const std::string& text) {
  fmt::print(stderr, "dartcast: {}\n", one_line(text));
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  namespace verbs = dartcast::app;
  CLI::App app("Carries particles through deforming meshes, exactly.", "dartcast");
  app.set_version_flag("--version", dartcast::version());
  app.require_subcommand(0, 1);
  int status = verbs::done;
  verbs::add_run(app, status);
  verbs::add_check(app, status);
  verbs::add_info(app, status);
  verbs::add_convert(app, status);
  verbs::add_trace(app, status);
#ifdef DARTCAST_BENCH
  verbs::add_bench(app, status);
#endif
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("one of run, check, info, convert, trace, bench");
  } catch (const CLI::Success& e) {
    return app.exit(e);  // help, version
  } catch (const CLI::ParseError& e) {
    return complain(verbs::wrong_usage, fmt::format("{}; see dartcast --help", e.what()));
  } catch (const std::bad_alloc&) {
    return complain(verbs::failed, "there is not enough memory for this");
  } catch (const std::exception& e) {
    return complain(verbs::failed, e.what());
  }
  return status;
}
