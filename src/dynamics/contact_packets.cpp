#include "dynamics/contact_packets.hpp"

#include <algorithm>

namespace dartcast::detail {

void ContactPackets::find_levels(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies) {
  behind_.assign(bodies.size(), 0);
  places_.resize(contacts.size());
  starts_.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactEnds c = contacts[i];
    const bool a_moves = bodies[c.a].inverse_mass > 0.0;
    const bool b_moves = bodies[c.b].inverse_mass > 0.0;
    const std::uint32_t level = std::max(a_moves ? behind_[c.a] : 0, b_moves ? behind_[c.b] : 0);
    if (a_moves) behind_[c.a] = level + 1;
    if (b_moves) behind_[c.b] = level + 1;
    if (2 * level == starts_.size()) starts_.insert(starts_.end(), 2, 0);
    places_[i] = 2 * level + (c.loaded ? 0 : 1);
    ++starts_[places_[i]];
  }
}

void ContactPackets::sort(std::span<const ContactEnds> contacts, std::span<const ContactBody> bodies) {
  find_levels(contacts, bodies);
  std::uint32_t packets = 0;
  for (std::size_t i = 0; i < starts_.size(); i += 2) {
    const std::uint32_t loaded = starts_[i];
    const std::uint32_t count = loaded + starts_[i + 1];
    starts_[i] = packets * packet_lanes;
    starts_[i + 1] = starts_[i] + loaded;
    packets += (count + packet_lanes - 1) / packet_lanes;
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

// Terms are read in an order of their own, from all over memory: so they are prefetched.
void ContactPackets::assign(std::span<const ContactEnds> contacts, std::span<const ContactTerms> terms,
                            std::span<const ContactBody> bodies) {
  constexpr std::size_t ahead = 16;
  sort(contacts, bodies);
  for (std::size_t p = 0; p < packets_.size(); ++p) {
    clear(p, static_cast<std::uint32_t>(bodies.size() - 1));
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
