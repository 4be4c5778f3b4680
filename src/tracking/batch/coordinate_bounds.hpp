// What barycentric coordinates kept in a memo (tracking/batch/simplex_cache.hpp) prove.
#pragma once

namespace dartcast::detail {

/// What coordinates prove, as computed in doubles: where all are above the margin, q lies strictly inside. Where all
/// are beyond the margin and none is above 2 in magnitude, each has its sign.
///
/// They are made for a particle p where the determinants d_i prove its coordinates and, E being the largest |r_i| of
/// the corners relative to p, V = sum d_i >= 2^-20 E^3, E <= 2^100; and for the gradients g_i, rounded to floats, with
/// |.| the largest magnitude, |.|_1 the sum: |g_i|_1 E <= 2^6, |g_i|_1 |p| <= 2^34. (u = 2^-53, R = |q - p|, all
/// coordinates those of the true simplex times its volume over V, which is 1 +- 2^-27.)
///
/// A coordinate is off by: 2^-18 R/E (1 + 2^-20), as floats round g (below 2^-126 by 2^-150: less than 2^-40 R/E);
/// 2^-26 R/E, as the cross products of differences of rounded r_i are off by 2^5 u E^2 in each component, over V;
/// 2^-30 + 2u, the determinants; 2^-17, the rounding of w; 2^-16.9 + 2^-44 R/E, that of the sum. In all less than
/// 2^-17.9 R/E + 2^-15.8.
///
/// q - p = sum l_i r_i with the true coordinates l_i, whose sum is 1: R <= E sum |l_i|. Where all computed ones are
/// above the margin, the scaled true ones are at least -2^-17.9 R/E, so none is above 1.01 + 2^-16 R/E and
/// R <= 4.1 E + 2^-13 R: R < 5 E. Where none is above 2 in magnitude, R <= 4 E (2.01 + 2^-17 R/E): R < 9 E. Either
/// way they are off by less than 2^-14.3.
inline constexpr double coordinate_margin = 0x1p-12;
inline constexpr double max_for_sign = 2.0;
inline constexpr double min_volume = 0x1p-20;           ///< V over E^3
inline constexpr double farthest_corner = 0x1p+100;     ///< E
inline constexpr double steepest_gradient = 64.0;       ///< |g|_1 E
inline constexpr double extents_from_origin = 0x1p+28;  ///< |p| over E that counts as much as E

}  // namespace dartcast::detail
