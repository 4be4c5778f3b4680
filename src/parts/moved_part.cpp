// Sends cells to other ranks.
#include "parts/moved_part.hpp"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/bytes.hpp"
#include "parts/merged_parts.hpp"
#include "parts/part_cutter.hpp"

namespace dartcast {

namespace {

// Calls visit(cell, ranks) for each own cell, with the values of all cells that share a point with it.
template <class Visit>
void for_each_own(const MeshPart& part, std::span<const std::uint32_t> value, Visit&& visit) {
  std::vector<std::vector<std::uint32_t>> around(part.points.size());
  const auto add = [](std::vector<std::uint32_t>& list, std::uint32_t v) {
    if (std::find(list.begin(), list.end(), v) == list.end()) list.push_back(v);
  };
  for (std::size_t c = 0; c < part.cells.size(); ++c)
    for_each_point(part.mesh, c, [&](std::uint32_t p) { add(around[p], value[c]); });
  std::vector<std::uint32_t> all;
  for (std::uint32_t c = 0; c < part.cells.size(); ++c) {
    if (part.owners[c] != part.part) continue;
    all.clear();
    for_each_point(part.mesh, c, [&](std::uint32_t p) {
      for (const std::uint32_t v : around[p]) add(all, v);
    });
    visit(c, std::as_const(all));
  }
}

}  // namespace

std::vector<std::uint32_t> next_owners(const MeshPart& part, std::vector<std::uint32_t> next, Ranks& ranks) {
  struct Entry {
    std::uint32_t cell;  // in the whole
    std::uint32_t next;
  };
  std::vector<std::vector<Entry>> to(ranks.size());
  for_each_own(part, part.owners, [&](std::uint32_t c, const std::vector<std::uint32_t>& owners) {
    for (const std::uint32_t rank : owners) {
      if (rank != part.part) to[rank].push_back({part.cells[c], next[c]});
    }
  });
  std::vector<std::string> bytes;
  for (const std::vector<Entry>& list : to) {
    ByteWriter out;
    out.put(list);
    bytes.push_back(out.bytes());
  }
  for (std::size_t c = 0; c < next.size(); ++c) {
    if (part.owners[c] != part.part) next[c] = part.owners[c];
  }
  for (const std::string& b : ranks.exchange(std::move(bytes))) {
    for (const Entry& e : ByteReader(b).take_list<Entry>()) {
      const auto found = std::lower_bound(part.cells.begin(), part.cells.end(), e.cell);
      if (found != part.cells.end() && *found == e.cell)
        next[static_cast<std::size_t>(found - part.cells.begin())] = e.next;
    }
  }
  return next;
}

MeshPart moved_part(const MeshPart& part, std::span<const std::uint32_t> next, Ranks& ranks) {
  std::vector<std::vector<std::uint32_t>> to(ranks.size());
  for_each_own(part, next, [&](std::uint32_t c, const std::vector<std::uint32_t>& owners) {
    for (const std::uint32_t rank : owners) to[rank].push_back(c);
  });
  PartCutter cutter(part, next);
  std::vector<std::string> bytes(ranks.size());
  for (std::uint32_t rank = 0; rank < to.size(); ++rank) {
    if (!to[rank].empty()) bytes[rank] = packed(cutter.cut(to[rank], rank));
  }
  std::vector<MeshPart> received;
  for (const std::string& b : ranks.exchange(std::move(bytes))) {
    if (!b.empty()) received.push_back(unpacked_part(b));
  }
  return merged_parts(received, ranks.size(), part.part);
}

}  // namespace dartcast
