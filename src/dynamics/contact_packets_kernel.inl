// The iterations of src/dynamics/contact_sweeps.cpp, compiled there once per instruction set: no include guard, no
// includes, and not to be included elsewhere. Defined before: DARTCAST_TARGET, the attribute of every function;
// any(Mask), root(Quad), join(Pair, Pair) and split(Quad, Pair&, Pair&).

// Vectors of four contacts, one in each lane.
struct Vec3x4 {
  Double4 x, y, z;
};
DARTCAST_TARGET inline Vec3x4 operator+(const Vec3x4& u, const Vec3x4& v) { return {u.x + v.x, u.y + v.y, u.z + v.z}; }
DARTCAST_TARGET inline Vec3x4 operator-(const Vec3x4& u, const Vec3x4& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
DARTCAST_TARGET inline Vec3x4 operator*(const Vec3x4& v, const Double4& s) { return {v.x * s, v.y * s, v.z * s}; }
DARTCAST_TARGET inline Double4 dot(const Vec3x4& u, const Vec3x4& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }

DARTCAST_TARGET inline Double4 load(const PacketNumbers& numbers) {
  return *reinterpret_cast<const Double4*>(&numbers);
}
DARTCAST_TARGET inline Vec3x4 load(const PacketVectors& v) { return {load(v[0]), load(v[1]), load(v[2])}; }
DARTCAST_TARGET inline void store(const Double4& four, PacketNumbers& to) { *reinterpret_cast<Double4*>(&to) = four; }

// One side of four contacts: velocities and inverse masses.
struct ContactSide {
  Vec3x4 velocity;
  Double4 inverse_mass;

  // Rows of bodies by halves: the upper half of a register comes from memory for the price of a load.
  DARTCAST_TARGET explicit ContactSide(const BodyRows& rows) {
    const Double4 xy02 = join(rows[0][0], rows[2][0]);
    const Double4 xy13 = join(rows[1][0], rows[3][0]);
    const Double4 zw02 = join(rows[0][1], rows[2][1]);
    const Double4 zw13 = join(rows[1][1], rows[3][1]);
    velocity = {__builtin_shufflevector(xy02, xy13, 0, 4, 2, 6), __builtin_shufflevector(xy02, xy13, 1, 5, 3, 7),
                __builtin_shufflevector(zw02, zw13, 0, 4, 2, 6)};
    inverse_mass = __builtin_shufflevector(zw02, zw13, 1, 5, 3, 7);
  }

  DARTCAST_TARGET void write(const BodyRows& rows) const {
    const Double4 xy02 = __builtin_shufflevector(velocity.x, velocity.y, 0, 4, 2, 6);
    const Double4 xy13 = __builtin_shufflevector(velocity.x, velocity.y, 1, 5, 3, 7);
    const Double4 zw02 = __builtin_shufflevector(velocity.z, inverse_mass, 0, 4, 2, 6);
    const Double4 zw13 = __builtin_shufflevector(velocity.z, inverse_mass, 1, 5, 3, 7);
    split(xy02, rows[0][0], rows[2][0]);
    split(xy13, rows[1][0], rows[3][0]);
    split(zw02, rows[0][1], rows[2][1]);
    split(zw13, rows[1][1], rows[3][1]);
  }
};

DARTCAST_TARGET inline Double4 positive_part(const Double4& x) { return x > 0.0 ? x : Double4{}; }

// Impulses on the spheres b, and the opposite ones on a.
DARTCAST_TARGET inline void apply(const Vec3x4& impulse, ContactSide& a, ContactSide& b, const BodyRows& a_rows,
                                  const BodyRows& b_rows) {
  a.velocity = a.velocity - impulse * a.inverse_mass;
  b.velocity = b.velocity + impulse * b.inverse_mass;
  a.write(a_rows);
  b.write(b_rows);
}

DARTCAST_TARGET inline void start_packet(const ContactPacket& p, const PacketImpulses& impulses, ContactBody* bodies) {
  const Double4 normal_impulse = load(impulses.normal_impulse);
  if (!any(normal_impulse > 0.0)) return;
  const BodyRows a_rows = rows_of(bodies, p.a);
  const BodyRows b_rows = rows_of(bodies, p.b);
  ContactSide a(a_rows);
  ContactSide b(b_rows);
  apply(load(p.normal) * normal_impulse + load(impulses.tangent_impulse), a, b, a_rows, b_rows);
}

// Friction acts across the normal: it changes nothing along it. What keeps sticking is at most the share of the impulse
// along the normal that friction allows, so that where that is 0 both are.
DARTCAST_TARGET inline void solve_packet(const ContactPacket& p, PacketImpulses& impulses,
                                         const PacketSurfaces& surfaces, ContactBody* bodies) {
  const BodyRows a_rows = rows_of(bodies, p.a);
  const BodyRows b_rows = rows_of(bodies, p.b);
  ContactSide a(a_rows);
  ContactSide b(b_rows);
  const Vec3x4 relative = b.velocity - a.velocity;
  const Vec3x4 normal = load(p.normal);
  const Double4 mass = load(p.mass);
  const Double4 nearing = dot(relative, normal);
  const Double4 along_before = load(impulses.normal_impulse);
  const Double4 normal_impulse = positive_part(along_before - mass * (nearing - load(p.bound)));
  if (!any(normal_impulse + along_before > 0.0)) return;
  const Vec3x4 across_before = load(impulses.tangent_impulse);
  Vec3x4 tangent_impulse = across_before - (relative - normal * nearing) * mass;
  const Double4 limit = load(surfaces.friction) * normal_impulse;
  const Double4 square = dot(tangent_impulse, tangent_impulse);
  const Mask4 slips = square > limit * limit;
  if (any(slips)) tangent_impulse = tangent_impulse * (slips ? limit / root(square) : 1.0 + Double4{});
  apply((tangent_impulse - across_before) + normal * (normal_impulse - along_before), a, b, a_rows, b_rows);
  store(normal_impulse, impulses.normal_impulse);
  store(tangent_impulse.x, impulses.tangent_impulse[0]);
  store(tangent_impulse.y, impulses.tangent_impulse[1]);
  store(tangent_impulse.z, impulses.tangent_impulse[2]);
}

DARTCAST_TARGET inline void correct_packet(const ContactPacket& p, PacketCorrections& corrections,
                                           ContactBody* bodies) {
  const BodyRows a_rows = rows_of(bodies, p.a);
  const BodyRows b_rows = rows_of(bodies, p.b);
  ContactSide a(a_rows);
  ContactSide b(b_rows);
  const Vec3x4 normal = load(p.normal);
  const Double4 before = load(corrections.position_correction);
  const Double4 nearing = dot(b.velocity - a.velocity, normal);
  const Double4 position_correction = positive_part(before - load(p.mass) * (nearing - load(corrections.bound)));
  if (!any(position_correction != before)) return;
  store(position_correction, corrections.position_correction);
  apply(normal * (position_correction - before), a, b, a_rows, b_rows);
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

DARTCAST_TARGET inline void correct_all(const PacketSpans& s, ContactBody* bodies, unsigned iterations) {
  for (unsigned left = iterations; left > 0; --left) {
    for (std::size_t i = 0; i < s.count; ++i) {
      const std::size_t k = left % 2 == 1 ? i : s.count - 1 - i;
      correct_packet(s.packets[k], s.corrections[k], bodies);
    }
  }
}
