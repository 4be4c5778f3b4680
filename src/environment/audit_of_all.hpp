// The audit of particles that ranks share. Not installed.
#pragma once

#include <string>

#include "base/reduced.hpp"
#include "dartcast/audit.hpp"

namespace dartcast {

/// The sum of the audits that the ranks have made of their own particles. Collective, if there are several.
inline Audit audit_of_all(Ranks* ranks, const Audit& own) {
  const auto add = [](Audit& sum, const Audit& other) { sum += other; };
  const auto pack = [](const Audit& a) {
    ByteWriter out;
    out.put(a.checked);
    out.put(a.failed);
    out.put(a.first);
    return out.bytes();
  };
  const auto unpack = [](const std::string& bytes) {
    ByteReader in(bytes);
    Audit a;
    a.checked = in.take<std::uint64_t>();
    a.failed = in.take<std::uint64_t>();
    a.first = in.take_text();
    return a;
  };
  return reduced(ranks, own, add, pack, unpack);
}

}  // namespace dartcast
