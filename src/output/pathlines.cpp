// Packs the points of pathlines for a file that grows, and makes polylines of them.
#include "output/pathlines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <numeric>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/statistics_files.hpp"
#include "formats/file_write.hpp"

namespace dartcast {

namespace {

// id, time, position, velocity, contact
constexpr std::size_t packed_size = 8 + 8 + 24 + 24 + 1;

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void take(const char*& bytes, T& value) {
  std::memcpy(&value, bytes, sizeof value);
  bytes += sizeof value;
}

PathPoint unpacked(const char* bytes) {
  PathPoint p;
  std::uint8_t contact = 0;
  take(bytes, p.id);
  take(bytes, p.time);
  take(bytes, p.position);
  take(bytes, p.velocity);
  take(bytes, contact);
  p.contact = contact != 0;
  return p;
}

}  // namespace

void PathlinesBuilder::add(const PathPoint& point) {
  if (positions_.size() == 0xffffffffU)
    throw Error("pathlines: there are more than 4294967295 points; choose fewer particles");
  const auto [found, made] = line_.try_emplace(point.id, static_cast<std::uint32_t>(ids_.size()));
  if (made) {
    ids_.push_back(point.id);
    sizes_.push_back(0);
  }
  ++sizes_[found->second];
  line_of_.push_back(found->second);
  positions_.push_back(point.position);
  times_.push_back(point.time);
  velocities_.push_back(point.velocity);
  contacts_.push_back(point.contact ? 1 : 0);
}

// The points stay in their order. The lines, by id, name them.
VtpFile PathlinesBuilder::file() {
  std::vector<std::uint32_t> order(ids_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return ids_[a] < ids_[b]; });
  std::vector<std::size_t> offsets = {0};
  std::vector<std::size_t> next(ids_.size());
  std::vector<std::int64_t> ids;
  for (const std::uint32_t line : order) {
    next[line] = offsets.back();
    offsets.push_back(offsets.back() + sizes_[line]);
    ids.push_back(static_cast<std::int64_t>(ids_[line]));
  }
  std::vector<std::uint32_t> corners(positions_.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) corners[next[line_of_[i]]++] = i;
  VtpFile file(std::move(positions_));
  file.add_lines(offsets, corners);
  file.add("time", std::move(times_));
  file.add("velocity", std::move(velocities_));
  file.add("contact", std::move(contacts_));
  file.add_for_cells("id", std::move(ids));
  return file;
}

std::string packed(const PathPoint& p) {
  std::string bytes;
  put(bytes, p.id);
  put(bytes, p.time);
  put(bytes, p.position);
  put(bytes, p.velocity);
  put(bytes, static_cast<std::uint8_t>(p.contact ? 1 : 0));
  return bytes;
}

VtpFile read_packed_pathlines(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string header;
  if (!std::getline(file, header) || header != pathlines_header)
    throw Error(fmt::format("{}: the file of pathlines cannot be read; run without --resume", path.string()));
  PathlinesBuilder lines;
  std::vector<char> block(packed_size * 4096);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto size = static_cast<std::size_t>(file.gcount());
    for (std::size_t at = 0; at + packed_size <= size; at += packed_size) lines.add(unpacked(block.data() + at));
  }
  return lines.file();
}

void write_pathlines(std::span<const PathPoint> points, const std::filesystem::path& file) {
  if (file.extension() != ".vtp")
    throw InvalidArgument(fmt::format("{}: pathlines are written as .vtp; give the file this ending", file.string()));
  PathlinesBuilder lines;
  for (const PathPoint& p : points) lines.add(p);
  write_xml(file, lines.file().data(), Compression::none, write_pieces);
}

}  // namespace dartcast
