// Forms sum c_i s^(d-i) t^i in exact integers, with s = 1 - t: their roots in (0, 1), and their signs at such roots.
//
// A form of degree d is a polynomial in t. Written so, products of points in linear motion need no expansion, and
// Bernstein's coefficients are c_i over binomials.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <vector>

namespace dartcast::detail {

/// Longer ones than this allocate memory. Products of three coordinates within a few powers of two of each other are shorter.
inline constexpr unsigned bits_in_place = 512;
using ExactInteger =
    boost::multiprecision::number<boost::multiprecision::cpp_int_backend<bits_in_place>, boost::multiprecision::et_off>;

struct ExactForm {
  int degree = 0;  // at most 3
  std::array<ExactInteger, 4> c;

  [[nodiscard]] bool is_zero() const;
};

ExactForm operator*(const ExactForm& f, const ExactForm& g);
ExactForm operator+(const ExactForm& f, const ExactForm& g);  // of one degree
ExactForm operator-(const ExactForm& f, const ExactForm& g);

/// A polynomial in t / s, the coefficient of the highest power last and not 0.
using ExactPolynomial = std::vector<ExactInteger>;

/// A time in [0, 1]: j / 2^k itself, or the only root of a square-free polynomial in the open (j, j + 1) / 2^k.
class ExactTime {
 public:
  static ExactTime start();
  static ExactTime end();

  /// The sign of f, of degree 2 at most, at this time. It may narrow the interval.
  int sign_of(const ExactForm& f);

  /// The time rounded down to a multiple of 2^-40.
  double rounded_down();

 private:
  friend std::vector<ExactTime> roots_inside(const ExactForm& f);

  void halve();
  [[nodiscard]] bool is_root_of(const ExactPolynomial& f) const;

  bool exact_ = true;
  int k_ = 0;
  ExactInteger j_;
  ExactPolynomial f_;    // of an interval
  int sign_before_ = 0;  // f's, at its start
};

/// The roots of f strictly between 0 and 1 in ascending order, each once. f is not 0 throughout.
std::vector<ExactTime> roots_inside(const ExactForm& f);

}  // namespace dartcast::detail
