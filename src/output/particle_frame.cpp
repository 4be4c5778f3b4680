// The arrays of a frame of particles, and the names of its files.
#include "output/particle_frame.hpp"

#include <fmt/format.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/vtp_write.hpp"
#include "output/particle_kinds.hpp"

namespace dartcast {

namespace {

// The value of each particle.
template <class Value>
auto each(std::size_t count, Value&& value) {
  std::vector<decltype(value(std::size_t{}))> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = value(i);
  return values;
}

template <class T>
std::vector<T> copy(std::span<const T> values) {
  return {values.begin(), values.end()};
}

VtpFile particles_file(const Simulation& simulation) {
  const Particles& particles = simulation.particles();
  const CellComplex& complex = simulation.environment().complex();
  const std::size_t n = particles.size();
  VtpFile file(each(n, [&](std::size_t i) { return particles[i].position; }));
  file.add_vertices();
  file.add("id", copy(simulation.ids()));
  file.add("radius", copy(simulation.radii()));
  file.add("velocity", copy(simulation.velocities()));
  file.add("cell", each(n, [&](std::size_t i) { return complex.map().source(particles[i].cell); }));
  file.add("kind", each(n, [&](std::size_t i) { return static_cast<std::uint8_t>(kind_of(complex, particles[i])); }));
  file.add("held", copy(simulation.held()));
  file.add("contacts", copy(simulation.contact_counts()));
  if (!simulation.options().forces.terms.empty()) {
    file.add("diameter", copy(simulation.diameters()));
    file.add("density", copy(simulation.densities()));
    file.add("charge_per_mass", copy(simulation.charges_per_mass()));
  }
  const std::vector<std::string>& names = simulation.options().user_data;
  for (std::size_t k = 0; k < names.size(); ++k)
    file.add(names[k], each(n, [&](std::size_t i) { return simulation.user_data(i)[k]; }));
  if (complex.periodic() != nullptr) file.add("unwrapped", simulation.unwrapped());
  return file;
}

}  // namespace

std::string particle_frame_name(const RecordingFrame& frame) {
  return frame_name("particles", frame.step, frame.pieces > 1 ? ".pvtp" : ".vtp");
}

XmlDataSet write_particles(WritingThread& writing, const std::filesystem::path& folder, const Simulation& simulation,
                           const RecordingFrame& frame, unsigned piece, Compression compression) {
  const std::string name =
      frame.pieces > 1 ? piece_name("particles", frame.step, piece, ".vtp") : particle_frame_name(frame);
  XmlDataSet data = particles_file(simulation).data();
  write_frame_file(writing, folder / name, data, compression);
  return data;
}

}  // namespace dartcast
