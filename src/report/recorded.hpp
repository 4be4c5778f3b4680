// The parts of report.bin: all that a report shows of the scene, recorded by a run as it goes. Not installed.
//
// The file is a row of chunks, each a tag, its size and its bytes. So a run can append to it, a resumed run can cut it
// off, and a reader can skip what it does not need. Positions are floats relative to an origin.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

using RecordedPoint = std::array<float, 3>;

/// The first line of the file. Chunks follow it.
inline constexpr std::string_view recorded_line = "dartcast report 2";

/// The first chunk.
struct RecordedHeader {
  static constexpr std::string_view tag = "HEAD";

  std::uint32_t dimension = 3;
  std::uint64_t every = 0;  ///< steps between two frames
  Vec3 origin;
};

/// A point relative to the origin of a recording. Coordinates beyond the range of floats are put to its end.
RecordedPoint recorded(const Vec3& x, const RecordedHeader& header);

/// The wall faces from the next frame on. Faces and their corners are numbered as they come.
struct RecordedWalls {
  static constexpr std::string_view tag = "WALL";

  std::vector<RecordedPoint> points;   ///< as they are at the next frame
  std::vector<std::uint32_t> corners;  ///< points of the faces
  std::vector<std::uint64_t> offsets;  ///< of the faces in `corners`; one more than faces
  std::vector<std::uint16_t> patches;  ///< of the faces
  std::vector<std::string> patch_names;
};

enum class SolidKind : std::uint8_t { body, catheter };

struct RecordedSolid {
  std::string name;
  SolidKind kind = SolidKind::body;
  float radius = 0.0F;
  std::vector<std::uint32_t> triangles;  ///< of its skin, as places in `points`; empty: none
  std::vector<RecordedPoint> points;
};

struct RecordedFrame {
  static constexpr std::string_view tag = "FRAM";

  std::uint64_t step = 0;
  double time = 0.0;         ///< s
  std::uint64_t stride = 1;  ///< particles are those whose id is a multiple of it
  std::uint64_t all = 0;     ///< particles that the run has had so far
  std::vector<std::uint64_t> ids;
  std::vector<RecordedPoint> positions;
  std::vector<float> speeds;  ///< m/s
  std::vector<float> radii;   ///< empty: all are points
  std::vector<std::uint8_t> kinds;
  std::vector<RecordedPoint> wall_points;  ///< empty: those of the walls, which have not moved since
  std::vector<std::uint32_t> hits;         ///< of the wall faces, so far; empty: none
  std::vector<RecordedSolid> solids;
};

struct RecordedContact {
  std::uint64_t id = 0;
  double time = 0.0;  ///< s
  RecordedPoint point{};
  std::uint16_t patch = 0;
  std::uint8_t kind = 0;
  std::uint8_t unused = 0;
};
static_assert(sizeof(RecordedContact) == 32);

/// The contacts of a step.
struct RecordedContacts {
  static constexpr std::string_view tag = "CONT";

  std::vector<RecordedContact> contacts;
};

/// The particles that have come by a moment.
struct RecordedArrivals {
  static constexpr std::string_view tag = "COME";

  double time = 0.0;      ///< s
  std::uint64_t all = 0;  ///< ids are below it
};

/// A change of the scene that the time line names.
struct RecordedEvent {
  static constexpr std::string_view tag = "EVNT";

  std::uint64_t step = 0;
  double time = 0.0;  ///< s
  std::string text;
};

/// A part as a chunk.
std::string chunk_of(const RecordedHeader& header);
std::string chunk_of(const RecordedWalls& walls);
std::string chunk_of(const RecordedFrame& frame);
std::string chunk_of(const RecordedContacts& contacts);
std::string chunk_of(const RecordedArrivals& arrivals);
std::string chunk_of(const RecordedEvent& event);

/// Reads report.bin, or a recording in memory. Every function throws Error, which names the file, if it cannot be read, or is damaged.
class RecordedFile {
 public:
  struct Chunk {
    std::string tag;
    std::uint64_t at = 0;
    std::uint64_t size = 0;
  };

  /// Reads where the chunks are. A last chunk that was not written whole is left out.
  explicit RecordedFile(const std::filesystem::path& path);
  /// The same of a file's bytes; `name`: for messages.
  RecordedFile(std::string name, std::string bytes);

  [[nodiscard]] const RecordedHeader& header() const { return header_; }
  [[nodiscard]] const std::vector<Chunk>& chunks() const { return chunks_; }
  struct Moment {
    std::uint64_t step = 0;
    double time = 0.0;  ///< s
  };
  /// The moment of a frame, without the rest of it.
  [[nodiscard]] Moment moment(const Chunk& frame) const;
  /// The part of a chunk with its tag. A returned part is consistent: lists that belong together have one length,
  /// numbers of points are below their count, and every coordinate is finite.
  template <class Part>
  [[nodiscard]] Part read(const Chunk& chunk) const;

 private:
  RecordedFile(std::string name, std::unique_ptr<std::istream> stream);
  [[nodiscard]] std::string bytes_of(const Chunk& chunk, std::uint64_t most = ~std::uint64_t{0}) const;

  std::string name_;
  std::unique_ptr<std::istream> stream_;
  std::vector<Chunk> chunks_;
  RecordedHeader header_;
};

}  // namespace dartcast
