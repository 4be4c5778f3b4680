// The paper's own scheme in the plane, as its authors would have written it: doubles and a tolerance, no exact signs,
// no mending.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009: map and cells of sections 3.1 and 3.2, states and forecasts of section 4.2 (face,
// edge, vertex), deformation of section 6.1. Every point/edge orientation is counted as one test: a forecast that is
// still valid takes three.
//
// Where the paper is silent:
//  - A determinant counts as zero below 1e-12 times the square of the mean edge length at the start.
//  - An edge met in passing is crossed at once: the test of the edge state would repeat the one just made. In the face
//    behind it the edge after the one crossed is aimed at first, since the crossed one holds p.
//  - Around a vertex, blocked faces are turned through as well; the particle stops where the last one reached is
//    blocked.
//  - Section 6.1 as its last paragraph says, as in space (bench/paper_scheme.hpp): after a deformation the step starts
//    at the mean of the cell's corners.
//  - A particle that takes more than paper_max_tests tests in a step turns in an endless loop and is given up.
#pragma once

#include "bench/paper_scheme.hpp"

namespace dartcast::bench {

/// The paper's state S = (p, k, i).
struct PaperState2D {
  Vec3 p;
  Dart i;  ///< the edge aimed at, or that p is on, or one that starts at the vertex p; its cell is free
  Kind k = Kind::face;
};

class PaperWalk2D;
using PaperScheme2D = PaperSchemeOf<PaperState2D, PaperWalk2D>;

}  // namespace dartcast::bench
