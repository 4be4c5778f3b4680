// Leaves frames and lists of frames to the thread that writes.
#include "output/frame_files.hpp"

#include <utility>
#include <vector>

#include "formats/file_write.hpp"

namespace dartcast {

void write_frame_file(WritingThread& writing, std::filesystem::path path, XmlDataSet data, Compression compression) {
  const std::size_t bytes = data.bytes();
  writing.add(bytes, [path = std::move(path), data = std::move(data), compression] {
    write_xml(path, data, compression, replace_file);
  });
}

void write_index(WritingThread& writing, const std::filesystem::path& folder, const RecordingFrame& frame,
                 std::string_view series, std::string_view ending, std::uint32_t pieces, const XmlDataSet& data) {
  std::vector<std::string> names;
  for (std::uint32_t piece = 0; piece < pieces; ++piece) names.push_back(piece_name(series, frame.step, piece, ending));
  const std::string index = ".p" + std::string(ending.substr(1));
  writing.add(pieces * sizeof(std::string), [path = folder / frame_name(series, frame.step, index), data,
                                             names = std::move(names)] { write_xml_of_pieces(path, data, names); });
}

void write_list(WritingThread& writing, std::filesystem::path path, std::span<const RecordingFrame> frames,
                std::function<std::string(const RecordingFrame&)> name) {
  std::vector<RecordingFrame> copy(frames.begin(), frames.end());
  writing.add(frames.size_bytes(), [path = std::move(path), frames = std::move(copy), name = std::move(name)] {
    write_pvd(path, frames, name);
  });
}

}  // namespace dartcast
