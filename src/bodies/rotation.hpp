// The rotation nearest to a matrix: the rotational part of its polar decomposition.
//
// As M. Mueller, J. Bender, N. Chentanez, M. Macklin, "A robust method to extract the rotational part of
// deformations", 2016, it starts from the last rotation; here each iteration is one of Newton's. Eigen's JacobiSVD
// takes cases that do not converge.
#pragma once

#include "dynamics/mat3.hpp"

namespace dartcast {

/// A rotation R is taken as the nearest one to A if R^T A is symmetric up to this share of A's Frobenius norm. This
/// means |axial(R^T A)| <= rotation_residual |A|. The product's entries are rounded by at most 5 u |A| each (u = 2^-53;
/// R is orthonormal up to 6 u). A component of the axial vector is a difference of two, off by less than 16 u |A|.
inline constexpr double rotation_residual = 0x1p-48;

/// Iterations before the fallback. From a start within 60 degrees four suffice; from one step to the next one or two.
inline constexpr int rotation_iterations = 8;

struct Rotation {
  Quaternion q;           ///< of length 1
  bool fallback = false;  ///< by Eigen's JacobiSVD
};

/// The rotation R (determinant +1, for any A) that makes |A - R| least in the Frobenius norm: R maximizes trace(R^T A).
/// If several do (A of rank 1, or inverted with two equal least singular values) it is one of them, always the same
/// for the same arguments. If A is 0, it is `start`. `start`: a guess of length 1, for example the last result; no
/// guess is wrong. Preconditions: finite. Cost: about 0.15 us from a near start, 0.4 us by the fallback.
Rotation nearest_rotation(const Mat3& a, const Quaternion& start);

}  // namespace dartcast
