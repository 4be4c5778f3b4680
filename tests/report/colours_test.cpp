// Whether people see the colours of pages, and distinguish them: contrasts after WCAG 2.2, and distances in CIELAB as seen
// by people who lack one kind of cones (G. Machado, M. Oliveira, L. Fernandes, "A physiologically-based model for
// simulation of color vision deficiency", 2009).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "report/chart.hpp"
#include "report/style.hpp"

namespace dartcast::colours_test {

using Colour = std::array<double, 3>;
using Matrix = std::array<Colour, 3>;

constexpr Matrix all_cones = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Matrix no_long = {
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix no_middle = {
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
constexpr Matrix no_short = {
    {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};
constexpr Matrix to_xyz = {{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};

Colour times(const Matrix& m, const Colour& c) {
  Colour r{};
  for (std::size_t i = 0; i < 3; ++i) r[i] = m[i][0] * c[0] + m[i][1] * c[1] + m[i][2] * c[2];
  return r;
}

// The value of a variable in the style, in linear light. `scheme`: 0 light, 1 dark.
Colour colour_of(const std::string& name, int scheme) {
  const std::string style(page_style);
  std::size_t at = style.find("--" + name + ":#");
  if (scheme == 1) at = style.find("--" + name + ":#", at + 1);
  EXPECT_NE(at, std::string::npos) << name;
  std::string digits = style.substr(style.find('#', at) + 1, 6);
  if (digits.find_first_not_of("0123456789abcdef") == 3)
    digits = {digits[0], digits[0], digits[1], digits[1], digits[2], digits[2]};
  Colour c{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = std::stoi(digits.substr(2 * i, 2), nullptr, 16) / 255.0;
    c[i] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  }
  return c;
}

double contrast(const Colour& a, const Colour& b) {
  const double x = times(to_xyz, a)[1] + 0.05;
  const double y = times(to_xyz, b)[1] + 0.05;
  return std::max(x, y) / std::min(x, y);
}

Colour lab(const Colour& linear) {
  Colour clipped = linear;
  for (double& x : clipped) x = std::min(1.0, std::max(0.0, x));
  Colour f = times(to_xyz, clipped);
  f[0] /= 0.9505;
  f[2] /= 1.089;
  for (double& x : f) x = x > 0.008856 ? std::cbrt(x) : 7.787 * x + 16.0 / 116.0;
  return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

double distance(const Colour& a, const Colour& b) {
  const Colour x = lab(a);
  const Colour y = lab(b);
  return std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
}

std::vector<Colour> categories(int scheme) {
  std::vector<Colour> all;
  for (int i = 0; i < 8; ++i) all.push_back(colour_of("c" + std::to_string(i), scheme));
  return all;
}

TEST(Colours, StandOutFromThePage) {
  for (const int scheme : {0, 1}) {
    for (const char* page : {"background", "panel"}) {
      const Colour behind = colour_of(page, scheme);
      EXPECT_GE(contrast(colour_of("text", scheme), behind), 7.0);
      EXPECT_GE(contrast(colour_of("muted", scheme), behind), 4.5);
      for (const Colour& c : categories(scheme)) EXPECT_GE(contrast(c, behind), 3.0) << scheme << page;
    }
  }
}

TEST(Colours, AreDistinctToColourBlindPeople) {
  constexpr double clearly = 20.0;  // a distance of 2 can just be seen
  for (const int scheme : {0, 1}) {
    const std::vector<Colour> all = categories(scheme);
    for (const Matrix& eye : {all_cones, no_long, no_middle, no_short}) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k)
          EXPECT_GE(distance(times(eye, all[i]), times(eye, all[k])), clearly) << scheme << " c" << k << " c" << i;
      }
    }
  }
}

// The colour of a patch: a variable, or two of them mixed as sRGB.
Colour colour_of_patch(std::size_t patch, int scheme) {
  const std::string text = patch_colour(patch);
  const auto variable = [&](std::size_t from) {
    const std::size_t at = text.find("--", from) + 2;
    return colour_of(text.substr(at, text.find(')', at) - at), scheme);
  };
  const Colour first = variable(0);
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) return first;
  const double share = std::stod(text.substr(text.rfind(' ', percent))) / 100.0;
  const Colour second = variable(percent);
  const auto encoded = [](double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055; };
  Colour mixed{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = share * encoded(first[i]) + (1.0 - share) * encoded(second[i]);
    mixed[i] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  }
  return mixed;
}

// More patches than there are colours: 64 of them can still be distinguished, if not at a glance.
TEST(Colours, OfPatchesAreDistinct) {
  constexpr std::size_t patches = 64;
  for (const int scheme : {0, 1}) {
    std::vector<Colour> all;
    for (std::size_t p = 1; p <= patches; ++p) all.push_back(colour_of_patch(p, scheme));
    for (std::size_t i = 0; i < patches; ++i) {
      EXPECT_GE(contrast(all[i], colour_of("panel", scheme)), 3.0) << scheme << " patch " << i + 1;
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GE(distance(all[i], all[k]), i < 24 ? 8.0 : 5.0) << scheme << " patches " << k + 1 << ' ' << i + 1;
    }
  }
}

}  // namespace dartcast::colours_test
