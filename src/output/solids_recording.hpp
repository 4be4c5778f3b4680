// Frames and tables of bodies, catheters and solids.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "formats/xml_write.hpp"
#include "output/recorder.hpp"

namespace dartcast {

/// For each body there is a series of its particles (body_NAME_000010.vtp, body_NAME.pvd) and of the surface that
/// follows them (surface_NAME_...). For each catheter there are its points (catheter_NAME_...) and, if the scene wants
/// them, a camera's places along it (camera_NAME_...). For each solid there are its vertices and faces
/// (solid_NAME_...). The tables bodies.csv, catheters.csv and solids.csv have a row per step and body, catheter or
/// solid. Their contacts are in solid_contacts.csv, if the scene wants contacts.
class SolidsRecording final : public Recorder {
 public:
  SolidsRecording(const RunFolder& run, const Scene& scene);

  void add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums) override;
  void add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) override;
  void save(FilesProgress& progress) override;

 private:
  void add_bodies(const Simulation& simulation);
  void add_catheters(const Simulation& simulation);
  void add_solids(const Simulation& simulation);
  void add_solid_contacts(const Simulation& simulation);
  void add_solid_contact(const Simulation& simulation, const std::string& name, const SolidContact& c);
  void add_meeting(const Simulation& simulation, const SolidMeeting& m);
  void write_body(const Simulation& simulation, std::size_t body, std::uint64_t step) const;
  void write_catheter(const Simulation& simulation, std::size_t i, std::uint64_t step) const;
  void write_solid(const Simulation& simulation, std::size_t i, std::uint64_t step) const;

  void write(const std::string& series, std::uint64_t step, const XmlDataSet& data) const;
  void write_series(const std::string& series, std::span<const RecordingFrame> frames) const;

  Compression compression_;
  RunTable bodies_;
  RunTable catheters_;
  RunTable solids_;
  RunTable solid_contacts_;
};

}  // namespace dartcast
