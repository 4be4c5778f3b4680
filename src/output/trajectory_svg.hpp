// One trajectory in the plane as a drawing, in the manner of figures 5 and 6 of T. Jund, D. Cazier, J.-F. Dufourd, SPM
// 2009: cut where it passes from cell to cell, with the particle's state at each crossing.
#pragma once

#include <span>
#include <string>

#include "dartcast/cell_complex.hpp"
#include "dartcast/trace.hpp"

namespace dartcast {

/// SVG: the cells around those passed (these tinted, blocked ones filled), the trajectory in pieces of alternating
/// colours (one more than there are crossings), a dot and a letter at the start, each crossing, target and the end (f
/// face, e edge, v vertex: the cell of the map that the particle is in there), a cross at each contact. What they are
/// is in their titles. Its size depends on the cells passed, not on the scene; positions are rounded to 1/100 of a
/// pixel, 800 of which are the longer side. The same bytes whatever the machine's locale.
///
/// `complex`: the one that the traces were made in, drawn as it stands. Throws InvalidArgument where there is no trace,
/// or where the complex is not of the plane. Cost: one look at each cell of the scene.
std::string trajectory_svg(const CellComplex& complex, std::span<const Trace> traces);

}  // namespace dartcast
