// The verb partition: writes a mesh in pieces, one for each process that will share it.
#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>

#include "commands.hpp"
#include "dartcast/mesh_files.hpp"
#include "limits.hpp"
#include "max_memory.hpp"
#include "terminal.hpp"

namespace dartcast::app {

namespace {

constexpr std::uint64_t max_parts = 65536;

struct PartitionArguments {
  std::string mesh;
  std::string out;
  std::uint32_t parts = 1;
  ReadOptions read;
};

int partition(const PartitionArguments& a) {
  const MeshData mesh = while_waiting("loading " + a.mesh, true, a.read,
                                      [&](const ReadOptions& read) { return read_valid_mesh(a.mesh, read).mesh; });
  write_mesh_parts(mesh, a.parts, a.out);
  fmt::print("{}: {} cells in {} pieces\n", a.out, mesh.cell_count(), a.parts);
  return done;
}

}  // namespace

void add_partition(CLI::App& app, int& status) {
  const auto a = std::make_shared<PartitionArguments>();
  CLI::App* verb = app.add_subcommand("partition", "Write a mesh in pieces, for runs with --partition cells.");
  verb->add_option("MESH", a->mesh, "the mesh to read")->required()->type_name("FILE");
  verb->add_option("-n,--parts", a->parts, "the number of pieces: 1 to 65536, as many as processes, or more")
      ->type_name("N")
      ->required()
      ->transform(whole_number(1, max_parts));
  verb->add_option("-o,--output", a->out, "the .pvtu file to write; the pieces, .vtu files, stand beside it")
      ->type_name("FILE")
      ->required();
  verb->add_flag("--linearise", a->read.linearise, "take the corners of cells of second order");
  add_max_memory(*verb, a->read.max_memory);
  verb->callback([a, &status] { status = partition(*a); });
}

}  // namespace dartcast::app
