// The verb replay: takes a recorded step again, alone, and says what is wrong with it.
#include "dartcast/replay.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "commands.hpp"

namespace dartcast::app {

namespace {

std::string text_of(const Vec3& p) { return fmt::format("({}, {}, {})", p.x, p.y, p.z); }

int replay_file(const std::string& file) {
  const StepReplay step = read_replay(file);
  fmt::print("recorded: {}\n", step.reason.empty() ? "nothing wrong" : step.reason);
  fmt::print("step: from {} to {}, {}, among {} cells\n", text_of(step.state.position), text_of(step.target),
             step.moved.empty()  ? "walls at rest"
             : step.simultaneous ? "walls move at the same time"
                                 : "the cells carry the particle",
             step.mesh.cell_count());
  if (step.end) fmt::print("it ended at {}\n", text_of(*step.end));
  const ReplayResult result = replay(step);
  for (const Contact& c : result.contacts.contacts)
    fmt::print("contact at {}, at {} of the step\n", text_of(c.point), c.time_of_impact);
  fmt::print("now it ends at {}{}\n", text_of(result.state.position), result.state.held ? ", held" : "");
  if (result.cut) fmt::print("it meets a face behind which the file has no cells: in the scene it goes on\n");
  fmt::print("{}\n", result.wrong.empty() ? "nothing is wrong" : "wrong: " + result.wrong);
  return result.wrong.empty() ? done : failed;
}

}  // namespace

void add_replay(CLI::App& app, int& status) {
  const auto file = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("replay", "Take a step again that went wrong in a run, alone, and check it.");
  verb->add_option("FILE", *file, "the replay.json that a run has left")->required()->type_name("FILE");
  verb->callback([file, &status] { status = replay_file(*file); });
}

}  // namespace dartcast::app
