// The iterations over packets of contacts, compiled for each instruction set.
#pragma once

#include <cstddef>

#include "dynamics/contact_packets.hpp"

namespace dartcast::detail {

struct PacketSpans {
  const ContactPacket* packets;
  PacketImpulses* impulses;
  const PacketSurfaces* surfaces;
  PacketCorrections* corrections;
};

// As start(), solve() and position_correction() of ContactPackets, for packets [begin, end).
namespace portable {
void start_packets(const PacketSpans& spans, ContactBody* bodies, std::size_t begin, std::size_t end);
void solve_packets(const PacketSpans& spans, ContactBody* bodies, std::size_t begin, std::size_t end, bool forwards);
void correct_packets(const PacketSpans& spans, ContactBody* bodies, std::size_t begin, std::size_t end, bool forwards);
}  // namespace portable

namespace avx2 {
void start_packets(const PacketSpans& spans, ContactBody* bodies, std::size_t begin, std::size_t end);
void solve_packets(const PacketSpans& spans, ContactBody* bodies, std::size_t begin, std::size_t end, bool forwards);
void correct_packets(const PacketSpans& spans, ContactBody* bodies, std::size_t begin, std::size_t end, bool forwards);
}  // namespace avx2

}  // namespace dartcast::detail
