// The files of frames, and their lists, left to the thread that writes.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "formats/xml_write.hpp"
#include "output/run_files.hpp"
#include "output/writing_thread.hpp"

namespace dartcast {

/// Leaves a file to the thread. Throws what an earlier job of the thread threw.
void write_frame_file(WritingThread& writing, std::filesystem::path path, XmlDataSet data, Compression compression);

/// The same for a list of frames, as write_pvd().
void write_list(WritingThread& writing, std::filesystem::path path, std::span<const RecordingFrame> frames,
                std::function<std::string(const RecordingFrame&)> name);

}  // namespace dartcast
