// A frame of a run's particles: one file, or a piece of each rank and an index of them. Not installed.
#pragma once

#include <filesystem>

#include "dartcast/simulation.hpp"
#include "output/frame_files.hpp"

namespace dartcast {

/// particles_000010.vtp; if there are several pieces, their index particles_000010.pvtp.
std::string particle_frame_name(const RecordingFrame& frame);

/// Leaves the particles of this rank to the thread: the frame, if it has one piece, or the piece of this number. Returns
/// the data, as other pieces have it.
XmlDataSet write_particles(WritingThread& writing, const std::filesystem::path& folder, const Simulation& simulation,
                           const RecordingFrame& frame, unsigned piece, Compression compression);

}  // namespace dartcast
