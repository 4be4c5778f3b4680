// The iterations of src/dynamics/contact_sweeps.cpp, compiled there once per instruction set: no include guard, no
// includes, and not to be included elsewhere. Defined before: DARTCAST_TARGET, the attribute of every function;
// any(Mask), root(Quad), join(Pair, Pair) and split(Quad, Pair&, Pair&).

// Vectors of four contacts, one in each lane.
struct Lanes {
  Quad x, y, z;
};
DARTCAST_TARGET inline Lanes operator+(const Lanes& u, const Lanes& v) { return {u.x + v.x, u.y + v.y, u.z + v.z}; }
DARTCAST_TARGET inline Lanes operator-(const Lanes& u, const Lanes& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
DARTCAST_TARGET inline Lanes operator*(const Lanes& v, const Quad& s) { return {v.x * s, v.y * s, v.z * s}; }
DARTCAST_TARGET inline Quad dot(const Lanes& u, const Lanes& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }

DARTCAST_TARGET inline Quad load(const PacketNumbers& numbers) { return *reinterpret_cast<const Quad*>(&numbers); }
DARTCAST_TARGET inline Lanes load(const PacketVectors& v) { return {load(v[0]), load(v[1]), load(v[2])}; }
DARTCAST_TARGET inline void store(const Quad& four, PacketNumbers& to) { *reinterpret_cast<Quad*>(&to) = four; }

// One side of four contacts: velocities and inverse masses.
struct Side {
  Lanes velocity;
  Quad inverse_mass;

  // Rows of bodies by halves: the upper half of a register comes from memory for the price of a load.
  DARTCAST_TARGET explicit Side(const BodyRows& rows) {
    const Quad xy02 = join(rows[0][0], rows[2][0]);
    const Quad xy13 = join(rows[1][0], rows[3][0]);
    const Quad zw02 = join(rows[0][1], rows[2][1]);
    const Quad zw13 = join(rows[1][1], rows[3][1]);
    velocity = {__builtin_shufflevector(xy02, xy13, 0, 4, 2, 6), __builtin_shufflevector(xy02, xy13, 1, 5, 3, 7),
                __builtin_shufflevector(zw02, zw13, 0, 4, 2, 6)};
    inverse_mass = __builtin_shufflevector(zw02, zw13, 1, 5, 3, 7);
  }

  DARTCAST_TARGET void write(const BodyRows& rows) const {
    const Quad xy02 = __builtin_shufflevector(velocity.x, velocity.y, 0, 4, 2, 6);
    const Quad xy13 = __builtin_shufflevector(velocity.x, velocity.y, 1, 5, 3, 7);
    const Quad zw02 = __builtin_shufflevector(velocity.z, inverse_mass, 0, 4, 2, 6);
    const Quad zw13 = __builtin_shufflevector(velocity.z, inverse_mass, 1, 5, 3, 7);
    split(xy02, rows[0][0], rows[2][0]);
    split(xy13, rows[1][0], rows[3][0]);
    split(zw02, rows[0][1], rows[2][1]);
    split(zw13, rows[1][1], rows[3][1]);
  }
};

DARTCAST_TARGET inline Quad positive_part(const Quad& x) { return x > 0.0 ? x : Quad{}; }

// Impulses on the spheres b, and the opposite ones on a.
DARTCAST_TARGET inline void apply(const Lanes& impulse, Side& a, Side& b, const BodyRows& a_rows,
                                  const BodyRows& b_rows) {
  a.velocity = a.velocity - impulse * a.inverse_mass;
  b.velocity = b.velocity + impulse * b.inverse_mass;
  a.write(a_rows);
  b.write(b_rows);
}

DARTCAST_TARGET inline void start_packet(const ContactPacket& p, const PacketImpulses& impulses, ContactBody* bodies) {
  const Quad along = load(impulses.along);
  if (!any(along > 0.0)) return;
  const BodyRows a_rows = rows_of(bodies, p.a);
  const BodyRows b_rows = rows_of(bodies, p.b);
  Side a(a_rows);
  Side b(b_rows);
  apply(load(p.normal) * along + load(impulses.across), a, b, a_rows, b_rows);
}

// Friction acts across the normal: it changes nothing along it. What keeps sticking is at most the share of the impulse
// along the normal that friction allows, so that where that is 0 both are.
DARTCAST_TARGET inline void solve_packet(const ContactPacket& p, PacketImpulses& impulses,
                                         const PacketSurfaces& surfaces, ContactBody* bodies) {
  const BodyRows a_rows = rows_of(bodies, p.a);
  const BodyRows b_rows = rows_of(bodies, p.b);
  Side a(a_rows);
  Side b(b_rows);
  const Lanes relative = b.velocity - a.velocity;
  const Lanes normal = load(p.normal);
  const Quad mass = load(p.mass);
  const Quad nearing = dot(relative, normal);
  const Quad along_before = load(impulses.along);
  const Quad along = positive_part(along_before - mass * (nearing - load(p.bound)));
  if (!any(along + along_before > 0.0)) return;
  const Lanes across_before = load(impulses.across);
  Lanes across = across_before - (relative - normal * nearing) * mass;
  const Quad most = load(surfaces.friction) * along;
  const Quad square = dot(across, across);
  const Mask slips = square > most * most;
  if (any(slips)) across = across * (slips ? most / root(square) : 1.0 + Quad{});
  apply((across - across_before) + normal * (along - along_before), a, b, a_rows, b_rows);
  store(along, impulses.along);
  store(across.x, impulses.across[0]);
  store(across.y, impulses.across[1]);
  store(across.z, impulses.across[2]);
}

DARTCAST_TARGET inline void push_packet(const ContactPacket& p, PacketPushes& pushes, ContactBody* bodies) {
  const BodyRows a_rows = rows_of(bodies, p.a);
  const BodyRows b_rows = rows_of(bodies, p.b);
  Side a(a_rows);
  Side b(b_rows);
  const Lanes normal = load(p.normal);
  const Quad before = load(pushes.push);
  const Quad nearing = dot(b.velocity - a.velocity, normal);
  const Quad push = positive_part(before - load(p.mass) * (nearing - load(pushes.bound)));
  if (!any(push != before)) return;
  store(push, pushes.push);
  apply(normal * (push - before), a, b, a_rows, b_rows);
}

DARTCAST_TARGET inline void start_all(const PacketSpans& s, ContactBody* bodies) {
  for (std::size_t i = 0; i < s.count; ++i) start_packet(s.packets[i], s.impulses[i], bodies);
}

// Backwards and forwards in turn; the last time forwards.
DARTCAST_TARGET inline void solve_all(const PacketSpans& s, ContactBody* bodies, unsigned iterations) {
  for (unsigned left = iterations; left > 0; --left) {
    for (std::size_t i = 0; i < s.count; ++i) {
      const std::size_t k = left % 2 == 1 ? i : s.count - 1 - i;
      solve_packet(s.packets[k], s.impulses[k], s.surfaces[k], bodies);
    }
  }
}

DARTCAST_TARGET inline void push_all(const PacketSpans& s, ContactBody* bodies, unsigned iterations) {
  for (unsigned left = iterations; left > 0; --left) {
    for (std::size_t i = 0; i < s.count; ++i) {
      const std::size_t k = left % 2 == 1 ? i : s.count - 1 - i;
      push_packet(s.packets[k], s.pushes[k], bodies);
    }
  }
}
