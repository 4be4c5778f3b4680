// Elements of the drawings.
#pragma once

#include <string>

namespace dartcast::bench::svg {

/// The size of a drawing, and the place of its diagram.
struct Frame {
  double width, height;
  double left, right, top, bottom;
};

/// A drawing that holds `content`, on white.
std::string page(double width, double height, const std::string& content);

std::string line(double x1, double y1, double x2, double y2, const char* colour);
std::string rectangle(double x, double y, double width, double height, const char* colour);

/// `anchor`: start, middle or end. `content` is XML.
std::string text(double x, double y, const char* anchor, const std::string& content);

/// A text with its special characters as XML wants them.
std::string escaped(const std::string& plain);

}  // namespace dartcast::bench::svg
