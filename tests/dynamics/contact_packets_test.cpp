#include "dynamics/contact_packets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::contact_packets_test {

using test::random_vector;

using detail::ContactBody;
using detail::ContactEnds;
using detail::ContactPackets;
using detail::ContactTerms;
using detail::InstructionSet;

// Contacts solved one after the other.
struct OneByOne {
  std::vector<std::size_t> order;
  std::vector<std::uint8_t> regions;  // by body
  std::size_t region_count = 1;
  std::vector<ContactEnds> ends;
  std::vector<ContactTerms> terms;
  std::vector<double> pushes;
  std::vector<ContactBody> bodies;

  void apply(std::size_t i, const Vec3& impulse, std::vector<ContactBody>& to) const {
    ContactBody& a = to[ends[i].a];
    ContactBody& b = to[ends[i].b];
    a.velocity -= impulse * a.inverse_mass;
    b.velocity += impulse * b.inverse_mass;
  }
  void start() {
    for (const std::size_t i : order) {
      if (terms[i].normal_impulse > 0.0)
        apply(i, terms[i].normal * terms[i].normal_impulse + terms[i].tangent_impulse, bodies);
    }
  }
  void solve(std::size_t i) {
    ContactTerms& t = terms[i];
    const Vec3 relative = bodies[ends[i].b].velocity - bodies[ends[i].a].velocity;
    const double nearing = dot(relative, t.normal);
    const double normal_impulse = std::max(0.0, t.normal_impulse - t.mass * (nearing - t.bound));
    if (normal_impulse == 0.0 && t.normal_impulse == 0.0) return;
    Vec3 tangent_impulse = t.tangent_impulse - (relative - t.normal * nearing) * t.mass;
    const double most = t.friction * normal_impulse;
    const double square = dot(tangent_impulse, tangent_impulse);
    if (square > most * most) tangent_impulse *= most / std::sqrt(square);
    apply(i, (tangent_impulse - t.tangent_impulse) + t.normal * (normal_impulse - t.normal_impulse), bodies);
    t.normal_impulse = normal_impulse;
    t.tangent_impulse = tangent_impulse;
  }
  void position_correction(std::size_t i, std::vector<ContactBody>& to) {
    const double nearing = dot(to[ends[i].b].velocity - to[ends[i].a].velocity, terms[i].normal);
    const double after = std::max(0.0, pushes[i] - terms[i].mass * (nearing - terms[i].position_bound));
    apply(i, terms[i].normal * (after - pushes[i]), to);
    pushes[i] = after;
  }
  template <class Each>
  void sweep(unsigned iterations, Each&& each) const {
    for (unsigned left = iterations; left > 0; --left) {
      for (std::size_t i = 0; i < order.size(); ++i) each(order[left % 2 == 1 ? i : order.size() - 1 - i]);
    }
  }
  void rebound() {
    for (ContactTerms& t : terms) {
      if (t.rebound > 0.0 && t.normal_impulse > 0.0) t.bound = t.rebound;
    }
  }
};

// Contacts among a few bodies, so that most share one with others. Some bodies cannot be pushed; some contacts begin
// with impulses, some rebound, some have no friction.
OneByOne random_contacts(Random& random, std::uint32_t body_count, std::size_t count) {
  OneByOne all;
  for (std::size_t i = 0; i < body_count; ++i)
    all.bodies.push_back({random_vector(random, 1.0), random.below(8) == 0 ? 0.0 : random.uniform(0.1, 3.0)});
  all.bodies[0].inverse_mass = 1.0;
  all.bodies.emplace_back();
  while (all.ends.size() < count) {
    const auto a = static_cast<std::uint32_t>(random.below(body_count));
    const auto b = static_cast<std::uint32_t>(random.below(body_count));
    const double inverse = all.bodies[a].inverse_mass + all.bodies[b].inverse_mass;
    if (a == b || !(inverse > 0.0)) continue;
    ContactTerms t;
    t.normal = random_vector(random, 1.0);
    t.normal *= 1.0 / norm(t.normal);
    t.mass = 1.0 / inverse;
    t.friction = random.below(3) == 0 ? 0.0 : random.uniform(0.0, 1.0);
    t.bound = random.below(2) == 0 ? 0.0 : random.uniform(-0.5, 0.0);
    t.position_bound = random.uniform(-0.5, 0.5);
    t.rebound = random.below(3) == 0 ? random.uniform(0.1, 1.0) : 0.0;
    const bool loaded = random.below(2) == 0;
    if (loaded) {
      t.normal_impulse = random.uniform(0.0, 0.2);
      t.tangent_impulse = cross(t.normal, random_vector(random, 1.0)) * (t.friction * t.normal_impulse / 2.0);
    }
    all.ends.push_back({a, b, loaded});
    all.terms.push_back(t);
  }
  all.pushes.assign(count, 0.0);
  return all;
}

void expect_same(const ContactPackets& packets, const OneByOne& truth, const std::vector<ContactBody>& bodies,
                 const char* when) {
  for (std::size_t i = 0; i < bodies.size(); ++i) ASSERT_EQ(bodies[i].velocity, truth.bodies[i].velocity) << when << i;
  for (std::size_t i = 0; i < truth.ends.size(); ++i) {
    ASSERT_EQ(packets.normal_impulse(i), truth.terms[i].normal_impulse) << when << i;
    ASSERT_EQ(packets.tangent_impulse(i), truth.terms[i].tangent_impulse) << when << i;
  }
}

// The order by its definition: the contacts within regions, then those between regions, and walls of their bodies.
std::vector<std::size_t> expected_order(const OneByOne& all) {
  const auto moves = [&](std::uint32_t body) { return all.bodies[body].inverse_mass > 0.0; };
  const auto between = [&](const ContactEnds& c) {
    return all.region_count > 1 && moves(c.a) && moves(c.b) && all.regions[c.a] != all.regions[c.b];
  };
  std::vector<bool> meets_other(all.bodies.size(), false);
  for (const ContactEnds& c : all.ends) {
    if (between(c)) meets_other[c.a] = meets_other[c.b] = true;
  }
  std::vector<std::size_t> order(all.ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
    const ContactEnds& c = all.ends[i];
    const bool wall = !moves(c.a) || !moves(c.b);
    return !between(c) && !(wall && meets_other[moves(c.a) ? c.a : c.b]);
  });
  return order;
}

void compare(OneByOne truth, InstructionSet set, unsigned iterations, Threads threads) {
  std::vector<ContactBody> bodies = truth.bodies;
  ContactPackets packets;
  packets.assign(truth.ends, truth.terms, bodies, truth.regions, truth.region_count, threads);
  truth.order = expected_order(truth);
  packets.start(bodies, threads, set);
  truth.start();
  expect_same(packets, truth, bodies, "start ");
  packets.solve(bodies, iterations, threads, set);
  truth.sweep(iterations, [&](std::size_t i) { truth.solve(i); });
  expect_same(packets, truth, bodies, "solve ");
  std::vector<ContactBody> pushed = bodies;
  std::vector<ContactBody> truly_pushed = bodies;
  packets.position_correction(pushed, iterations, threads, set);
  truth.sweep(iterations, [&](std::size_t i) { truth.position_correction(i, truly_pushed); });
  for (std::size_t i = 0; i < bodies.size(); ++i) ASSERT_EQ(pushed[i].velocity, truly_pushed[i].velocity) << i;
  const bool any = std::any_of(truth.terms.begin(), truth.terms.end(),
                               [](const ContactTerms& t) { return t.rebound > 0.0 && t.normal_impulse > 0.0; });
  EXPECT_EQ(packets.rebound(), any);
  truth.rebound();
  for (std::size_t i = 0; i < truth.ends.size(); ++i)
    ASSERT_EQ(packets.rebounds(i), truth.terms[i].rebound > 0.0 && truth.terms[i].normal_impulse > 0.0);
  packets.solve(bodies, iterations, threads, set);
  truth.sweep(iterations, [&](std::size_t i) { truth.solve(i); });
  expect_same(packets, truth, bodies, "rebound ");
}

// To the last bit, by any instructions, however many contacts a body is in.
TEST(ContactPackets, SameAsOneByOne) {
  Random random(1);
  for (int k = 0; k < std::max(4, test::scaled(60, 2000)); ++k) {
    const std::uint32_t bodies = 2 + static_cast<std::uint32_t>(random.below(k % 2 == 0 ? 8 : 200));
    const OneByOne contacts = random_contacts(random, bodies, random.below(300));
    const auto iterations = static_cast<unsigned>(random.below(5));
    compare(contacts, InstructionSet::portable, iterations, {1});
    compare(contacts, detail::best_instruction_set(), iterations, {1});
  }
}

// In regions, a body that cannot be pushed is in one contact.
void divide(OneByOne& all, Random& random, std::uint32_t region_count) {
  for (ContactEnds& c : all.ends) {
    for (std::uint32_t* end : {&c.a, &c.b}) {
      if (all.bodies[*end].inverse_mass > 0.0) continue;
      all.bodies.push_back(all.bodies[*end]);
      *end = static_cast<std::uint32_t>(all.bodies.size() - 1);
    }
  }
  for (std::size_t i = 0; i < all.bodies.size(); ++i)
    all.regions.push_back(static_cast<std::uint8_t>(random.below(region_count)));
  all.region_count = region_count;
  all.bodies.insert(all.bodies.end(), region_count + 1, {});
}

// In regions on any number of threads, too.
TEST(ContactPackets, RegionsAreSolvedBesideEachOther) {
  Random random(2);
  for (int k = 0; k < 6; ++k) {
    OneByOne contacts = random_contacts(random, k < 3 ? 60 : 800, k < 3 ? 150 : 2000);
    divide(contacts, random, 2 + static_cast<std::uint32_t>(random.below(6)));
    for (const unsigned threads : {1U, 2U, 3U, 7U}) compare(contacts, detail::best_instruction_set(), 5, {threads});
  }
}

// Contacts that share nothing that moves fill packets; those of one body wait for each other.
TEST(ContactPackets, FourAtATime) {
  const auto packets_of = [](double shared_inverse_mass) {
    std::vector<ContactBody> bodies(22);
    std::vector<ContactEnds> star;
    for (ContactBody& b : bodies) b.inverse_mass = 1.0;
    bodies[0].inverse_mass = shared_inverse_mass;
    for (std::uint32_t i = 1; i < 21; ++i) star.push_back({0, i, i % 3 == 0});
    bodies.back() = {};
    ContactPackets packets;
    packets.assign(star, std::vector<ContactTerms>(star.size()), bodies, {}, 1, {1});
    return packets.packet_count();
  };
  EXPECT_EQ(packets_of(0.0), 5U);
  EXPECT_EQ(packets_of(1.0), 20U);
}

}  // namespace dartcast::contact_packets_test
