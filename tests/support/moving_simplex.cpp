// Sturm's chain needs remainders up to a positive factor only, so that nothing is divided.
#include "support/moving_simplex.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dartcast::test {

namespace {

Polynomial trimmed(std::vector<Dyadic> factors) {
  while (!factors.empty() && factors.back() == 0.0) factors.pop_back();
  return {std::move(factors)};
}

Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  for (std::size_t i = 1; i < p.factors.size(); ++i) d.factors.push_back(p.factors[i] * static_cast<double>(i));
  return d;
}

// The remainder of a by b times some positive number.
Polynomial remainder(Polynomial a, const Polynomial& b) {
  const Dyadic& lead = b.factors.back();
  while (a.factors.size() >= b.factors.size()) {
    const Dyadic top = a.factors.back() * lead;
    const std::size_t shift = a.factors.size() - b.factors.size();
    for (Dyadic& c : a.factors) c = c * lead * lead;
    for (std::size_t i = 0; i < b.factors.size(); ++i) a.factors[i + shift] -= top * b.factors[i];
    a = trimmed(std::move(a.factors));
  }
  return a;
}

Dyadic value(const Polynomial& p, const Dyadic& time) {
  Dyadic sum;
  for (std::size_t i = p.factors.size(); i-- > 0;) sum = sum * time + p.factors[i];
  return sum;
}

}  // namespace

Polynomial operator+(const Polynomial& a, const Polynomial& b) {
  std::vector<Dyadic> sum(std::max(a.factors.size(), b.factors.size()));
  for (std::size_t i = 0; i < a.factors.size(); ++i) sum[i] += a.factors[i];
  for (std::size_t i = 0; i < b.factors.size(); ++i) sum[i] += b.factors[i];
  return trimmed(std::move(sum));
}

Polynomial operator-(const Polynomial& a) {
  Polynomial negative = a;
  for (Dyadic& c : negative.factors) c = -c;
  return negative;
}

Polynomial operator-(const Polynomial& a, const Polynomial& b) { return a + -b; }

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (a.factors.empty() || b.factors.empty()) return {};
  std::vector<Dyadic> product(a.factors.size() + b.factors.size() - 1);
  for (std::size_t i = 0; i < a.factors.size(); ++i) {
    for (std::size_t j = 0; j < b.factors.size(); ++j) product[i + j] += a.factors[i] * b.factors[j];
  }
  return trimmed(std::move(product));
}

MovingSimplex::MovingSimplex(const Corners& before, const Corners& after) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = [axis](const Vec3& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
    int lowest = 2000;
    for (const Corners* corners : {&before, &after}) {
      for (const Vec3& p : *corners) lowest = at(p) == 0.0 ? lowest : std::min(lowest, std::ilogb(at(p)));
    }
    const Dyadic unit = Dyadic::power_of_two(-lowest);
    for (std::size_t i = 0; i < 4; ++i) {
      const Dyadic from = unit * at(before[i]);
      corners_[i][axis] = trimmed({from, unit * at(after[i]) - from});
    }
  }
  volume_ = dot(edge(1), cross(edge(2), edge(3)));
  chain_ = {volume_, derivative(volume_)};
  while (!chain_.back().factors.empty()) chain_.push_back(-remainder(chain_[chain_.size() - 2], chain_.back()));
}

int MovingSimplex::sign_of_volume(const Dyadic& time) const { return value(volume_, time).sign(); }

bool MovingSimplex::has_root_by(const Dyadic& time) const {
  return sign_of_volume(time) <= 0 || changes(0.0) != changes(time);
}

Dyadic MovingSimplex::last_before_root(int bits) const {
  Dyadic last;
  for (int bit = 1; bit <= bits; ++bit) {
    const Dyadic middle = last + Dyadic::power_of_two(-bit);
    if (!has_root_by(middle)) last = middle;
  }
  return last;
}

std::array<int, 4> MovingSimplex::facet_signs(const Dyadic& time) const {
  std::array<Exact3<Dyadic>, 4> area;
  for (std::size_t i = 1; i < 4; ++i) {
    const Point facet = cross(edge(i % 3 + 1), edge((i + 1) % 3 + 1));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      area[i][axis] = value(facet[axis], time);
      area[0][axis] -= area[i][axis];
    }
  }
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (dot(area[i], area[i]) > dot(area[longest], area[longest])) longest = i;
  }
  std::array<int, 4> signs;
  for (std::size_t i = 0; i < 4; ++i) signs[i] = dot(area[i], area[longest]).sign();
  return signs;
}

MovingSimplex::Point MovingSimplex::edge(std::size_t i) const { return minus(corners_[i], corners_[0]); }

int MovingSimplex::changes(const Dyadic& time) const {
  int count = 0;
  int last = 0;
  for (const Polynomial& p : chain_) {
    const int sign = value(p, time).sign();
    if (sign == 0) continue;
    count += last != 0 && sign != last ? 1 : 0;
    last = sign;
  }
  return count;
}

}  // namespace dartcast::test
