// The bounds within which coordinates along a particle's line prove signs.
#pragma once

namespace dartcast::detail {

/// The line of a step from p to q, with D = q - p, has coordinates of its own. Axis z is that on which |D| is largest.
/// The others, (u, v) = (x - s_x z, y - s_y z), are those of a point relative to p, sheared along the line, with
/// s = (D_x, D_y) / D_z. So the line is the axis u = v = 0, and det(a - p, b - p, q - p) = D_z (u_a v_b - v_a u_b):
/// subtracting multiples of D changes no determinant.
///
/// Let G be at least |u|, |v|, |z| of all points used, and D_z; all between 2^-200 and 2^200; e = 2^-53. All below
/// follows from the roundings of doubles.
///
/// - u and v are off by e (|x| + 5 |z| + |u|) <= 8 e G. So the side u_a v_b - v_a u_b is off by 32 e G^2 from these, and
///   by 4 e G^2 from its own rounding: less than 64 e G^2. It is at most 2 G^2. z is off by e G.
/// - The end: det(a - q, b - q, c - q) is the sum of three sides times z - D_z. It is off by
///   3 (36 e G^2) (2 G) + 3 (2 G^2) (4 e G) + 36 e G^3 = 276 e G^3: less than 384 e G^3.
/// - The volume of a triangle a, b, c and a corner d is z_d (bc + ca + ab), less z_a (bc + db - dc) and two more sums
///   like this. Here bc is the side of b and c. A sum of three sides is off by 3 (36 e G^2) + 10 e G^2 = 118 e G^2, and
///   at most 6 G^2. So each product is off by 118 e G^3 + 6 e G^3 + 6 e G^3 = 130 e G^3. The whole is off by
///   4 (130 e G^3) + (12 + 18 + 24) e G^3 = 574 e G^3: less than 2048 e G^3.
/// - z is monotone: if the rounded z of a point is below the rounded D_z, the point itself is.
///
/// Walks that pass whole cells round u, v, z to floats. Let M be at least |u|, |v| of the floats, f = 2^-24, and G
/// between 2^-40 and 2^40. Then no product overflows, and what underflows is less than 2^-20 e G^2.
///
/// - A side of floats is off by 4 f M^2 as u and v are rounded. Its own rounding adds 4 f M^2, and 32 e G^2 are as
///   above; terms of f^2 are less than f M^2 / 2^20. Together this is less than 2^-20 M^2 + 64 e G^2, by so much that
///   the bound may be rounded, too.
/// - z stays monotone.
/// - Let all cells be positive, and the line pass no edge of a cell. It leaves the cell at a triangle if it passes it
///   on its way out. If there is one such triangle alone, the walk through the simplices leaves by it, if it leaves at
///   all. It does if all corners of that face are before the target: then so is every simplex on the way.
/// - The triangles of the face that was entered by are not asked about. To leave by one and come back by the other, the
///   line must pass two adjacent edges of this face on their outer side. So walks are asked for no such edges.
inline constexpr double side_error = 0x1p-47;          ///< over G^2
inline constexpr double end_error = 0x1.8p-45;         ///< over G^3
inline constexpr double volume_error = 0x1p-42;        ///< over G^3
inline constexpr double nearest_reach = 0x1p-200;      ///< G
inline constexpr double farthest_reach = 0x1p+200;     ///< G
inline constexpr double reach_of_first_simplex = 8.0;  ///< G over the largest coordinate there, but for 2 D_z

inline constexpr float rounded_side_error = 0x1p-20F;        ///< over M^2
inline constexpr double nearest_reach_of_floats = 0x1p-40;   ///< G
inline constexpr double farthest_reach_of_floats = 0x1p+40;  ///< G

}  // namespace dartcast::detail
