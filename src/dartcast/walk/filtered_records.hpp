// What a batch notes of its steps, all left as it is when the batch is made. Part of walk/filtered_kernel.hpp: no
// include guard, no includes.

// A simplex that a walk has come to.
struct Visit {
  std::uint32_t particle;
  std::uint32_t cell;   // its value
  std::uint16_t index;  // of the simplex, or of the face that was entered through
  std::uint16_t place;  // facet that was entered by (no_facet: none), or triangle of that face
  std::uint16_t tests;  // so far
  std::uint16_t exact;  // of these, those that the filter left open
  bool through_face;
};

// Where a particle has ridden to.
struct Ridden {
  double x, y, z;
};
// A walk that may leave its first simplex, and what is proved of its target.
struct Departure {
  std::uint32_t particle;
  Signs signs;
};
struct Arrival {
  std::uint32_t particle;
  std::uint32_t place;  // in the block
};
struct FacetArrival {
  std::uint32_t particle;
  std::uint16_t place;
  Mark on;
};
