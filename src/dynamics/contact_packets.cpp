// Sorts contacts into parts, levels, and packets of four without a common body.
#include "dynamics/contact_packets.hpp"

#include <algorithm>

namespace dartcast::detail {

// A wall's contact comes behind all pairs of its sphere, so that no sphere ends with a velocity into a wall.
void ContactPackets::find_parts(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies,
                                std::span<const std::uint8_t> regions) {
  levels_.assign(contacts.size(), {});
  if (parts_.size() == 1) return;
  const auto last = static_cast<std::uint32_t>(parts_.size() - 1);
  const auto is_pair = [&](const ContactEnds& c) {
    return bodies[c.a].inverse_mass > 0.0 && bodies[c.b].inverse_mass > 0.0;
  };
  between_.assign(bodies.size(), 0);
  for (const ContactEnds& c : contacts) {
    if (is_pair(c) && regions[c.a] != regions[c.b]) between_[c.a] = between_[c.b] = 1;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactEnds& c = contacts[i];
    const std::uint32_t mover = bodies[c.a].inverse_mass > 0.0 ? c.a : c.b;
    const bool in_last = is_pair(c) ? regions[c.a] != regions[c.b] : between_[mover] != 0;
    levels_[i].part = in_last ? last : regions[mover];
  }
}

// All contacts of a body within its region come before those between regions, so one counter serves for both. It
// starts again with the last part.
void ContactPackets::find_levels(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies) {
  for (const bool between : {false, true}) {
    behind_.assign(bodies.size(), 0);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      Place& place = levels_[i];
      if ((parts_.size() > 1 && place.part + 1 == parts_.size()) != between) continue;
      const ContactEnds c = contacts[i];
      const bool a_moves = bodies[c.a].inverse_mass > 0.0;
      const bool b_moves = bodies[c.b].inverse_mass > 0.0;
      place.level = std::max(a_moves ? behind_[c.a] : 0, b_moves ? behind_[c.b] : 0);
      if (a_moves) behind_[c.a] = place.level + 1;
      if (b_moves) behind_[c.b] = place.level + 1;
      parts_[place.part].levels = std::max(parts_[place.part].levels, place.level + 1);
    }
    if (parts_.size() == 1) break;
  }
}

void ContactPackets::sort(std::span<const ContactEnds> contacts) {
  std::uint32_t levels = 0;
  for (Part& part : parts_) {
    part.first_level = levels;
    levels += part.levels;
  }
  starts_.assign(2 * std::size_t{levels}, 0);
  places_.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    places_[i] = 2 * (parts_[levels_[i].part].first_level + levels_[i].level) + (contacts[i].loaded ? 0 : 1);
    ++starts_[places_[i]];
  }
  std::uint32_t packets = 0;
  for (Part& part : parts_) {
    part.begin = packets;
    for (std::size_t i = 2 * part.first_level; i < 2 * (std::size_t{part.first_level} + part.levels); i += 2) {
      const std::uint32_t loaded = starts_[i];
      const std::uint32_t count = loaded + starts_[i + 1];
      starts_[i] = packets * packet_lanes;
      starts_[i + 1] = starts_[i] + loaded;
      packets += (count + packet_lanes - 1) / packet_lanes;
    }
    part.end = packets;
  }
  packets_.resize(packets);
  impulses_.resize(packets);
  surfaces_.resize(packets);
  corrections_.resize(packets);
  order_.assign(packet_lanes * std::size_t{packets}, nothing);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    places_[i] = starts_[places_[i]]++;
    order_[places_[i]] = static_cast<std::uint32_t>(i);
  }
}

void ContactPackets::clear(std::size_t p, std::uint32_t nobody) {
  packets_[p] = {};
  packets_[p].a.fill(nobody);
  packets_[p].b.fill(nobody);
  impulses_[p] = {};
  surfaces_[p] = {};
  corrections_[p] = {};
}

void ContactPackets::set(std::size_t p, std::size_t l, const ContactEnds& ends, const ContactTerms& terms) {
  const auto put = [l](PacketVectors& to, const Vec3& v) {
    to[0][l] = v.x;
    to[1][l] = v.y;
    to[2][l] = v.z;
  };
  ContactPacket& packet_now = packets_[p];
  packet_now.a[l] = ends.a;
  packet_now.b[l] = ends.b;
  put(packet_now.normal, terms.normal);
  packet_now.mass[l] = terms.mass;
  packet_now.bound[l] = terms.bound;
  impulses_[p].normal_impulse[l] = terms.normal_impulse;
  put(impulses_[p].tangent_impulse, terms.tangent_impulse);
  surfaces_[p].friction[l] = terms.friction;
  surfaces_[p].rebound[l] = terms.rebound;
  corrections_[p].bound[l] = terms.position_bound;
}

// Terms are read in another order, from all over memory, so they are prefetched.
void ContactPackets::fill(std::size_t begin, std::size_t end, std::uint32_t nobody,
                          std::span<const ContactEnds> contacts, std::span<const ContactTerms> terms) {
  constexpr std::size_t ahead = 16;
  for (std::size_t p = begin; p < end; ++p) {
    clear(p, nobody);
    for (std::size_t l = 0; l < packet_lanes; ++l) {
      const std::size_t place = packet_lanes * p + l;
      if (place + ahead < order_.size() && order_[place + ahead] != nothing) {
        __builtin_prefetch(&terms[order_[place + ahead]]);
        __builtin_prefetch(&terms[order_[place + ahead]].normal_impulse);
      }
      const std::uint32_t i = order_[place];
      if (i != nothing) set(p, l, contacts[i], terms[i]);
    }
  }
}

// Each part has a body of its own that fills its packets, because threads write to it.
void ContactPackets::assign(std::span<const ContactEnds> contacts, std::span<const ContactTerms> terms,
                            std::span<const ContactBody> bodies, std::span<const std::uint8_t> regions,
                            std::size_t region_count, Threads threads) {
  parts_.assign(region_count > 1 ? region_count + 1 : 1, {});
  find_parts(contacts, bodies, regions);
  find_levels(contacts, bodies);
  sort(contacts);
  parallel_for(parts_.size(), 1, threads, [&](std::size_t part, std::size_t) {
    fill(parts_[part].begin, parts_[part].end, static_cast<std::uint32_t>(bodies.size() - 1 - part), contacts, terms);
  });
}

bool ContactPackets::rebound() {
  bool any = false;
  for (std::size_t p = 0; p < packets_.size(); ++p) {
    for (std::size_t l = 0; l < packet_lanes; ++l) {
      double& rebound = surfaces_[p].rebound[l];
      if (!(rebound > 0.0)) continue;
      if (!(impulses_[p].normal_impulse[l] > 0.0)) {
        rebound = 0.0;
        continue;
      }
      packets_[p].bound[l] = rebound;
      any = true;
    }
  }
  return any;
}

}  // namespace dartcast::detail
