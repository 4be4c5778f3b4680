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
  std::size_t count;
};

// As start(), solve() and position_correction() of ContactPackets.
namespace portable {
void start_all(const PacketSpans& spans, ContactBody* bodies);
void solve_all(const PacketSpans& spans, ContactBody* bodies, unsigned iterations);
void correct_all(const PacketSpans& spans, ContactBody* bodies, unsigned iterations);
}  // namespace portable

namespace avx2 {
void start_all(const PacketSpans& spans, ContactBody* bodies);
void solve_all(const PacketSpans& spans, ContactBody* bodies, unsigned iterations);
void correct_all(const PacketSpans& spans, ContactBody* bodies, unsigned iterations);
}  // namespace avx2

}  // namespace dartcast::detail
