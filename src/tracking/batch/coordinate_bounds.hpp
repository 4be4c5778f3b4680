// The bounds within which barycentric coordinates in a simplex cache (tracking/batch/simplex_cache.hpp) prove signs.
#pragma once

namespace dartcast::detail {

/// Coordinates of q, computed in doubles, prove this. If all are above the margin, q lies strictly inside. If all have
/// magnitudes between the margin and 2, each has its true sign.
///
/// Let p be the particle, r_i the corners relative to p, and E the largest |r_i|. Let d_i be the determinants of p, V
/// their sum, g_i the gradients rounded to floats, u = 2^-53 and R = |q - p|. |.| is the largest magnitude of a
/// vector's components, |.|_1 their sum. Coordinates are made only if the d_i prove those of p and four bounds hold.
/// These are V >= 2^-20 E^3, E <= 2^100, |g_i|_1 E <= 2^6 and |g_i|_1 |p| <= 2^34. Below, coordinates are those of the
/// true simplex times its volume over V, which is 1 +- 2^-27.
///
/// The errors of a coordinate are:
/// - 2^-18 R/E (1 + 2^-20), as floats round g (numbers below 2^-126 by 2^-150: less than 2^-40 R/E);
/// - 2^-26 R/E, as cross products of differences of rounded r_i are off by 2^5 u E^2 in each component, over V;
/// - 2^-30 + 2u, of the determinants;
/// - 2^-17, of rounding w;
/// - 2^-16.9 + 2^-44 R/E, of rounding the sum.
/// The total is less than 2^-17.9 R/E + 2^-15.8.
///
/// With the true coordinates l_i, whose sum is 1, q - p = sum l_i r_i, so that R <= E sum |l_i|. If all computed ones
/// are above the margin, the scaled true ones are at least -2^-17.9 R/E. So none is above 1.01 + 2^-16 R/E, and
/// R <= 4.1 E + 2^-13 R: R < 5 E. If none is above 2 in magnitude, R <= 4 E (2.01 + 2^-17 R/E): R < 9 E. In both cases
/// the error is less than 2^-14.3.
inline constexpr double coordinate_margin = 0x1p-12;
inline constexpr double max_for_sign = 2.0;
/// A coordinate below minus this: the target is some simplices away, and the walk goes along its line. Determinants say
/// so. If a kept coordinate is above minus the second number, they are known to deny it: no count of tests depends on
/// what is kept.
inline constexpr double far_coordinate = 1.5;
inline constexpr double surely_near = far_coordinate - 0x1p-10;
/// Below minus this the target is some cells away, and the walk may pass whole cells. Measured.
inline constexpr double farther_coordinate = 4.0;
inline constexpr double min_volume = 0x1p-20;           ///< V over E^3
inline constexpr double farthest_corner = 0x1p+100;     ///< E
inline constexpr double steepest_gradient = 64.0;       ///< |g|_1 E
inline constexpr double extents_from_origin = 0x1p+28;  ///< |p| over E that counts as much as E

}  // namespace dartcast::detail
