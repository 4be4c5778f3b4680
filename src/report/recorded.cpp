// Packs and unpacks the parts of report.bin.
//
// Phases of reading: the list of chunks; then each chunk by itself. Its lengths and numbers are checked, so that later
// code can trust them.
#include "report/recorded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <utility>

#include "base/bytes.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

constexpr std::size_t head_size = 4 + 8;  // of a chunk: tag and size

std::string chunk(std::string_view tag, const ByteWriter& content) {
  ByteWriter head;
  head.put(static_cast<std::uint64_t>(content.bytes().size()));
  return std::string(tag) + head.bytes() + content.bytes();
}

void expect(bool holds, const char* rule) {
  if (!holds) throw Error(fmt::format("it is damaged: {}", rule));
}

void expect_finite(const std::vector<RecordedPoint>& points) {
  for (const RecordedPoint& p : points)
    expect(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]), "a coordinate is not finite");
}

RecordedHeader unpack(ByteReader& in, const RecordedHeader* /*kind*/) {
  RecordedHeader h;
  h.dimension = in.take<std::uint32_t>();
  h.every = in.take<std::uint64_t>();
  h.origin = in.take<Vec3>();
  expect(h.dimension == 2 || h.dimension == 3, "the dimension is neither 2 nor 3");
  expect(std::isfinite(h.origin.x) && std::isfinite(h.origin.y) && std::isfinite(h.origin.z),
         "the origin is not finite");
  return h;
}

RecordedWalls unpack(ByteReader& in, const RecordedWalls* /*kind*/) {
  RecordedWalls w;
  w.points = in.take_list<RecordedPoint>();
  w.corners = in.take_list<std::uint32_t>();
  w.offsets = in.take_list<std::uint64_t>();
  w.patches = in.take_list<std::uint16_t>();
  const auto names = in.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < names; ++i) w.patch_names.push_back(in.take_text());
  expect(w.offsets.size() == w.patches.size() + 1, "there is not one patch for each wall face");
  expect(w.offsets.front() == 0 && w.offsets.back() == w.corners.size() &&
             std::is_sorted(w.offsets.begin(), w.offsets.end()),
         "wall faces do not follow one another");
  expect(std::all_of(w.corners.begin(), w.corners.end(), [&](std::uint32_t c) { return c < w.points.size(); }),
         "a wall face has a corner that does not exist");
  expect(std::all_of(w.patches.begin(), w.patches.end(), [&](std::uint16_t p) { return p < w.patch_names.size(); }),
         "a patch has no name");
  expect_finite(w.points);
  return w;
}

RecordedSolid unpack_solid(ByteReader& in) {
  RecordedSolid s;
  s.name = in.take_text();
  const auto kind = in.take<std::uint8_t>();
  expect(kind <= static_cast<std::uint8_t>(SolidKind::catheter), "a solid is of no known kind");
  s.kind = static_cast<SolidKind>(kind);
  s.radius = in.take<float>();
  s.triangles = in.take_list<std::uint32_t>();
  s.points = in.take_list<RecordedPoint>();
  expect(std::isfinite(s.radius), "the radius of a solid is not finite");
  expect(s.triangles.size() % 3 == 0 &&
             std::all_of(s.triangles.begin(), s.triangles.end(), [&](std::uint32_t c) { return c < s.points.size(); }),
         "a triangle of a solid has a corner that does not exist");
  expect_finite(s.points);
  return s;
}

RecordedFrame unpack(ByteReader& in, const RecordedFrame* /*kind*/) {
  RecordedFrame f;
  f.step = in.take<std::uint64_t>();
  f.time = in.take<double>();
  f.stride = in.take<std::uint64_t>();
  f.all = in.take<std::uint64_t>();
  f.ids = in.take_list<std::uint64_t>();
  f.positions = in.take_list<RecordedPoint>();
  f.speeds = in.take_list<float>();
  f.radii = in.take_list<float>();
  f.kinds = in.take_list<std::uint8_t>();
  f.wall_points = in.take_list<RecordedPoint>();
  f.hits = in.take_list<std::uint32_t>();
  const auto solids = in.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < solids; ++i) f.solids.push_back(unpack_solid(in));
  const std::size_t n = f.ids.size();
  expect(std::isfinite(f.time) && f.stride > 0, "the time of a frame is not finite, or its stride is 0");
  expect(f.positions.size() == n && f.speeds.size() == n && f.kinds.size() == n &&
             (f.radii.empty() || f.radii.size() == n),
         "the particles of a frame do not have one value each");
  expect(std::all_of(f.speeds.begin(), f.speeds.end(), [](float v) { return !std::isnan(v); }), "a speed is no number");
  expect(std::all_of(f.radii.begin(), f.radii.end(), [](float r) { return std::isfinite(r); }),
         "a radius is not finite");
  expect_finite(f.positions);
  expect_finite(f.wall_points);
  return f;
}

RecordedContacts unpack(ByteReader& in, const RecordedContacts* /*kind*/) {
  RecordedContacts c{in.take_list<RecordedContact>()};
  for (const RecordedContact& one : c.contacts) {
    expect(std::isfinite(one.time), "the time of a contact is not finite");
    expect(std::isfinite(one.point[0]) && std::isfinite(one.point[1]) && std::isfinite(one.point[2]),
           "a coordinate is not finite");
  }
  return c;
}

RecordedArrivals unpack(ByteReader& in, const RecordedArrivals* /*kind*/) {
  RecordedArrivals a;
  a.time = in.take<double>();
  a.all = in.take<std::uint64_t>();
  expect(std::isfinite(a.time), "the time of arrivals is not finite");
  return a;
}

RecordedEvent unpack(ByteReader& in, const RecordedEvent* /*kind*/) {
  RecordedEvent e;
  e.step = in.take<std::uint64_t>();
  e.time = in.take<double>();
  e.text = in.take_text();
  expect(std::isfinite(e.time), "the time of an event is not finite");
  return e;
}

}  // namespace

RecordedPoint recorded(const Vec3& x, const RecordedHeader& header) {
  static constexpr double end = std::numeric_limits<float>::max();
  const auto one = [](double value) { return static_cast<float>(std::clamp(value, -end, end)); };
  return {one(x.x - header.origin.x), one(x.y - header.origin.y), one(x.z - header.origin.z)};
}

std::string chunk_of(const RecordedHeader& h) {
  ByteWriter out;
  out.put(h.dimension);
  out.put(h.every);
  out.put(h.origin);
  return chunk(RecordedHeader::tag, out);
}

std::string chunk_of(const RecordedWalls& w) {
  ByteWriter out;
  out.put(w.points);
  out.put(w.corners);
  out.put(w.offsets);
  out.put(w.patches);
  out.put(static_cast<std::uint64_t>(w.patch_names.size()));
  for (const std::string& name : w.patch_names) out.put(name);
  return chunk(RecordedWalls::tag, out);
}

std::string chunk_of(const RecordedFrame& f) {
  ByteWriter out;
  out.put(f.step);
  out.put(f.time);
  out.put(f.stride);
  out.put(f.all);
  out.put(f.ids);
  out.put(f.positions);
  out.put(f.speeds);
  out.put(f.radii);
  out.put(f.kinds);
  out.put(f.wall_points);
  out.put(f.hits);
  out.put(static_cast<std::uint64_t>(f.solids.size()));
  for (const RecordedSolid& s : f.solids) {
    out.put(s.name);
    out.put(s.kind);
    out.put(s.radius);
    out.put(s.triangles);
    out.put(s.points);
  }
  return chunk(RecordedFrame::tag, out);
}

std::string chunk_of(const RecordedContacts& c) {
  ByteWriter out;
  out.put(c.contacts);
  return chunk(RecordedContacts::tag, out);
}

std::string chunk_of(const RecordedArrivals& arrivals) {
  ByteWriter out;
  out.put(arrivals.time);
  out.put(arrivals.all);
  return chunk(RecordedArrivals::tag, out);
}

std::string chunk_of(const RecordedEvent& e) {
  ByteWriter out;
  out.put(e.step);
  out.put(e.time);
  out.put(e.text);
  return chunk(RecordedEvent::tag, out);
}

namespace {

std::unique_ptr<std::istream> opened(const std::filesystem::path& path) {
  auto stream = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*stream)
    throw Error(fmt::format("{}: it cannot be read; run the scene with every > 0 and report = true in [output]",
                            path.string()));
  return stream;
}

std::uint64_t length_of(std::istream& stream) {
  stream.seekg(0, std::ios::end);
  const auto length = static_cast<std::uint64_t>(stream.tellg());
  stream.seekg(0);
  return length;
}

}  // namespace

RecordedFile::RecordedFile(const std::filesystem::path& path) : RecordedFile(path.string(), opened(path)) {}

RecordedFile::RecordedFile(std::string name, std::string bytes)
    : RecordedFile(std::move(name), std::make_unique<std::istringstream>(std::move(bytes), std::ios::binary)) {}

RecordedFile::RecordedFile(std::string name, std::unique_ptr<std::istream> stream)
    : name_(std::move(name)), stream_(std::move(stream)) {
  const std::uint64_t length = length_of(*stream_);
  std::string line;
  if (!std::getline(*stream_, line) || line != recorded_line)
    throw Error(fmt::format("{}: it is no recording of this version: run the scene again", name_));
  for (std::uint64_t at = line.size() + 1; at + head_size <= length;) {
    Chunk next{std::string(4, '\0'), at + head_size, 0};
    stream_->seekg(static_cast<std::streamoff>(at));
    stream_->read(next.tag.data(), 4);
    stream_->read(reinterpret_cast<char*>(&next.size), sizeof next.size);
    if (!*stream_ || next.size > length - next.at) break;
    at = next.at + next.size;
    chunks_.push_back(std::move(next));
  }
  if (chunks_.empty() || chunks_.front().tag != RecordedHeader::tag)
    throw Error(fmt::format("{}: it is no recording of a run", name_));
  header_ = read<RecordedHeader>(chunks_.front());
}

std::string RecordedFile::bytes_of(const Chunk& chunk, std::uint64_t most) const {
  std::string bytes(std::min(chunk.size, most), '\0');
  stream_->clear();
  stream_->seekg(static_cast<std::streamoff>(chunk.at));
  if (!stream_->read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw Error(fmt::format("{}: it cannot be read at byte {}", name_, chunk.at));
  return bytes;
}

RecordedFile::Moment RecordedFile::moment(const Chunk& frame) const {
  const std::string bytes = bytes_of(frame, 16);
  ByteReader in(bytes);
  Moment moment;
  moment.step = in.take<std::uint64_t>();
  moment.time = in.take<double>();
  return moment;
}

template <class Part>
Part RecordedFile::read(const Chunk& chunk) const {
  const std::string bytes = bytes_of(chunk);
  try {
    ByteReader in(bytes);
    return unpack(in, static_cast<const Part*>(nullptr));
  } catch (const Error& e) {
    throw Error(fmt::format("{}: at byte {}: {}", name_, chunk.at, e.what()));
  }
}

template RecordedHeader RecordedFile::read(const Chunk& chunk) const;
template RecordedWalls RecordedFile::read(const Chunk& chunk) const;
template RecordedFrame RecordedFile::read(const Chunk& chunk) const;
template RecordedContacts RecordedFile::read(const Chunk& chunk) const;
template RecordedArrivals RecordedFile::read(const Chunk& chunk) const;
template RecordedEvent RecordedFile::read(const Chunk& chunk) const;

}  // namespace dartcast
