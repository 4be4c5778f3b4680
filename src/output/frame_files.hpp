// The files of frames, and their lists, left to the thread that writes.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "formats/xml_write.hpp"
#include "output/run_files.hpp"
#include "output/writing_thread.hpp"

namespace dartcast {

/// Leaves a file to the thread. Throws what an earlier job of the thread threw.
void write_frame_file(WritingThread& writing, std::filesystem::path path, XmlDataSet data, Compression compression);

/// The same for the index of a frame of several pieces, of which `data` is one. `series` and `ending`: of their names.
void write_index(WritingThread& writing, const std::filesystem::path& folder, const RecordingFrame& frame,
                 std::string_view series, std::string_view ending, std::uint32_t pieces, const XmlDataSet& data);

/// The same for a list of frames, as write_pvd().
void write_list(WritingThread& writing, std::filesystem::path path, std::span<const RecordingFrame> frames,
                std::function<std::string(const RecordingFrame&)> name);

}  // namespace dartcast
