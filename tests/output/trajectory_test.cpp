// A trajectory as a drawing and as a table: as many pieces as there are, in order, well formed, the same bytes
// anywhere.
#include "dartcast/trajectory.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <locale>
#include <string>
#include <string_view>
#include <vector>

#include "base/random.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"

namespace dartcast::trajectory_test {

Environment squares(std::uint32_t edge, bool mixed = false, double blocked = 0.0) {
  RectangleOptions o;
  o.cells = {edge, edge};
  o.size = {static_cast<double>(edge), static_cast<double>(edge)};
  o.mixed = mixed;
  o.blocked_share = blocked;
  return Environment(generate_rectangle(o));
}

std::vector<Trace> trace_of(Environment& environment, const Vec3& from, const std::vector<Vec3>& to,
                            const ContactCallback& respond = {}) {
  Particles set;
  if (environment.add(set, {&from, 1})[0].location.place != Place::free) return {};
  return environment.trace(set, 0, to, respond);
}

std::size_t crossings_of(const std::vector<Trace>& traces) {
  std::size_t count = 0;
  for (const Trace& t : traces) count += t.crossings.size();
  return count;
}

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// Elements that close in the order in which they open, attributes in pairs of quotes, nothing to be escaped.
std::string what_is_malformed(std::string_view xml) {
  std::vector<std::string_view> open;
  std::size_t at = 0;
  while (at < xml.size()) {
    const std::size_t begin = xml.find('<', at);
    const std::string_view text = xml.substr(at, begin - at);
    if (text.find_first_of(">&") != std::string_view::npos) return "loose text: " + std::string(text);
    if (begin == std::string_view::npos) break;
    const std::size_t end = xml.find('>', begin);
    if (end == std::string_view::npos) return "a tag without an end";
    const std::string_view tag = xml.substr(begin + 1, end - begin - 1);
    if (tag.find_first_of("<&") != std::string_view::npos || count(tag, "\"") % 2 != 0)
      return "a broken tag: " + std::string(tag);
    at = end + 1;
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return "closes what is not open: " + std::string(tag);
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty() ? std::string() : "not closed: " + std::string(open.back());
}

// The points of each piece.
std::vector<std::vector<std::string>> pieces_of(std::string_view svg) {
  constexpr std::string_view begin = " points=\"";
  std::vector<std::vector<std::string>> pieces;
  for (std::size_t at = svg.find(begin); at != std::string_view::npos; at = svg.find(begin, at)) {
    at += begin.size();
    std::string points(svg.substr(at, svg.find('"', at) - at));
    auto& piece = pieces.emplace_back();
    for (std::size_t space = 0; space != std::string::npos; points.erase(0, space + 1)) {
      space = points.find(' ');
      piece.push_back(points.substr(0, space));
      if (space == std::string::npos) break;
    }
  }
  return pieces;
}

TEST(TrajectorySvg, HasAPieceMoreThanCrossings) {
  Random random(3);
  std::size_t drawn = 0;
  for (int i = 0; i < 100; ++i) {
    Environment environment = squares(8, i % 2 == 1, i % 3 == 0 ? 0.1 : 0.0);
    const auto draw = [&] { return Vec3{random.below(33) / 4.0, random.below(33) / 4.0, 0}; };
    const ContactCallback respond = [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
      return AfterContact{reflected(c.unused, walls, 1.0, 0.0), false};
    };
    const Vec3 from = draw();
    const std::vector<Trace> traces =
        trace_of(environment, from, {draw(), draw()}, i % 4 == 0 ? respond : ContactCallback{});
    if (traces.empty()) continue;
    const std::string svg = trajectory_svg(environment.complex(), traces);
    ASSERT_EQ(what_is_malformed(svg), "") << svg;
    ASSERT_EQ(svg.rfind("<svg xmlns=\"http://www.w3.org/2000/svg\" ", 0), 0U);
    const auto pieces = pieces_of(svg);
    const std::size_t crossings = crossings_of(traces);
    ASSERT_EQ(pieces.size(), crossings + 1);
    const std::vector<TrajectoryPoint> points = trajectory_points(traces);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const TrajectoryPoint& before = points[k - 1];
      if (points[k].step == before.step) ASSERT_GE(points[k].time, before.time);
      if (points[k].mark == TrajectoryMark::contact) continue;  // its wall may be that of a neighbour
      if (before.mark != TrajectoryMark::contact)
        ASSERT_EQ(points[k].cell, before.next.valid() ? before.next : before.cell);
    }
    std::size_t bends = 0;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (k > 0) ASSERT_EQ(pieces[k].front(), pieces[k - 1].back()) << "pieces follow one another";
      ASSERT_GE(pieces[k].size(), 2U);
      bends += pieces[k].size() - 2;
    }
    std::size_t contacts = 0;
    for (const Trace& t : traces) contacts += t.contacts.contacts.size();
    EXPECT_EQ(bends, contacts + traces.size() - 1);
    EXPECT_EQ(count(svg, "class=\"contact\""), contacts);
    EXPECT_EQ(count(svg, "</text>"), crossings + traces.size() + 1) << "a letter for each state";
    EXPECT_EQ(count(svg, "class=\"dot\""), crossings + traces.size() - 1);
    EXPECT_EQ(count(svg, "class=\"start\""), 1U);
    EXPECT_EQ(count(svg, "class=\"end\""), 1U);
    ++drawn;
  }
  EXPECT_GT(drawn, 80U);
}

TEST(TrajectorySvg, ShowsStatesAndCells) {
  Environment environment = squares(4);
  const auto traces = trace_of(environment, {0.5, 0.5, 0}, {{1.5, 1.5, 0}, {1.5, 3.0, 0}});
  const std::string svg = trajectory_svg(environment.complex(), traces);
  // Cells 0, 5 and 9 are passed: 2 wide, 3 high, and 8% of that around. 3.48 units are 800 pixels.
  EXPECT_NE(svg.find("viewBox=\"0 0 570.11 800\""), std::string::npos) << svg.substr(0, 200);
  EXPECT_NE(svg.find("<title>step 1, t = 0.5: crossing, vertex, cell 0 to 5</title>"), std::string::npos);
  EXPECT_EQ(count(svg, ">v</text>"), 1U);
  EXPECT_EQ(count(svg, ">e</text>"), 2U) << "the crossing from 5 to 9, and the end";
  EXPECT_EQ(count(svg, ">f</text>"), 2U) << "the start, and the first target";
  EXPECT_EQ(pieces_of(svg)[0], (std::vector<std::string>{"170.11,629.89", "285.06,514.94"}));
  const std::size_t passed = svg.find("class=\"passed\"");
  EXPECT_EQ(count(std::string_view(svg).substr(passed, svg.find("/>", passed) - passed), "Z"), 3U);
}

TEST(TrajectorySvg, IsSmallInALargeScene) {
  Environment environment = squares(300);
  const auto traces = trace_of(environment, {150.5, 150.25, 0}, {{154.5, 151.5, 0}});
  const std::string svg = trajectory_svg(environment.complex(), traces);
  EXPECT_LT(svg.size(), 8000U);
  EXPECT_EQ(pieces_of(svg).size(), traces[0].crossings.size() + 1);
}

class Commas : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(TrajectorySvg, IsTheSameInAnyLocale) {
  Environment environment = squares(5, true);
  const auto traces = trace_of(environment, {0.3, 0.4, 0}, {{4.7, 4.1, 0}});
  const std::string svg = trajectory_svg(environment.complex(), traces);
  const std::string csv = trajectory_csv(environment.map(), traces);
  const std::locale before = std::locale::global(std::locale(std::locale(), new Commas));
  EXPECT_EQ(trajectory_svg(environment.complex(), traces), svg);
  EXPECT_EQ(trajectory_csv(environment.map(), traces), csv);
  std::locale::global(before);
}

TEST(TrajectorySvg, RefusesSpaceAndNothing) {
  BoxOptions box;
  box.cells = {3, 3, 3};
  box.size = {1.0, 1.0, 1.0};
  Environment space(generate_box(box));
  const auto traces = trace_of(space, {0.1, 0.1, 0.1}, {{0.9, 0.8, 0.7}});
  ASSERT_EQ(traces.size(), 1U);
  try {
    (void)trajectory_svg(space.complex(), traces);
    FAIL() << "drawn";
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find(".csv"), std::string::npos);
  }
  EXPECT_THROW((void)trajectory_svg(squares(2).complex(), {}), InvalidArgument);
}

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t at = 0; at < csv.size();) {
    const std::size_t end = csv.find('\n', at);
    std::string row = csv.substr(at, end - at) + ",";
    auto& fields = rows.emplace_back();
    for (std::size_t comma; (comma = row.find(',')) != std::string::npos; row.erase(0, comma + 1))
      fields.push_back(row.substr(0, comma));
    at = end + 1;
  }
  return rows;
}

TEST(TrajectoryCsv, HasARowForEachEventAndEveryBit) {
  BoxOptions box;
  box.cells = {3, 3, 3};
  box.size = {1.0, 1.0, 1.0};
  box.jitter = 0.3;
  Environment environment(generate_box(box));
  const auto traces = trace_of(environment, {0.1, 0.15, 0.2}, {{0.9, 0.8, 0.7}, {0.5, 0.1, 2.0}});
  const auto rows = rows_of(trajectory_csv(environment.map(), traces));
  const std::vector<TrajectoryPoint> points = trajectory_points(traces);
  ASSERT_EQ(rows.size(), points.size() + 1);
  ASSERT_EQ(points.size(), 2 + 2 + crossings_of(traces)) << "start, target, contact, end";
  EXPECT_EQ(rows[0], (std::vector<std::string>{"step", "time", "event", "kind", "x", "y", "z", "cell", "next"}));
  EXPECT_EQ(rows[1][2], "start");
  EXPECT_EQ(rows[1][3], "volume");
  EXPECT_EQ(rows.back()[2], "end");
  EXPECT_EQ(rows.back()[0], "2");
  EXPECT_EQ(rows[rows.size() - 2][2], "contact");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& row = rows[i + 1];
    ASSERT_EQ(row.size(), 9U);
    EXPECT_EQ(std::strtod(row[1].c_str(), nullptr), points[i].time);
    const Vec3 x = {std::strtod(row[4].c_str(), nullptr), std::strtod(row[5].c_str(), nullptr),
                    std::strtod(row[6].c_str(), nullptr)};
    EXPECT_EQ(x, points[i].point);
    EXPECT_EQ(row[8].empty(), row[2] != "crossing");
    if (i == 0) continue;
    const auto& before = rows[i];
    EXPECT_EQ(row[7], before[8].empty() ? before[7] : before[8]) << "cells follow one another";
  }
}

}  // namespace dartcast::trajectory_test
