// Charts of a page as SVG. Their colours are variables of the page's style, so that they suit light and dark. Not
// installed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dartcast {

struct ChartSeries {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
};

struct Chart {
  std::string title;
  std::string x_label{};
  std::string y_label{};
  bool log_x = false;
  bool log_y = false;  ///< if not, the axis has 0
};

/// Lines, each with its name in the legend if there are several. Series of many points are thinned out, with their
/// peaks kept.
std::string line_chart(const Chart& chart, const std::vector<ChartSeries>& series);

struct Bar {
  std::string name;
  double value = 0.0;
  std::string label;  ///< the value in words
  std::string colour = "var(--c0)";
};
/// The colour of a patch, 0: none, as the viewer has it (viewer/src/colours.js).
std::string patch_colour(std::size_t patch);
/// Horizontal bars with their names and values.
std::string bar_chart(const Chart& chart, const std::vector<Bar>& bars);

/// Vertical bars over whole numbers: value i belongs to the number `first` + i. Bars so low that they would not be seen
/// have the height of a pixel.
std::string histogram_chart(const Chart& chart, std::size_t first, const std::vector<double>& values);

/// A text as HTML wants it. Control characters, and bytes that are no UTF-8, become U+FFFD.
std::string html(std::string_view text);

}  // namespace dartcast
