// A branching vessel of hexahedra, with its lumen and its wall of tissue.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "generators/vessel_section.hpp"
#include "mesh/faces.hpp"

namespace dartcast {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int lumen_region = 1, tissue_region = 2;
constexpr int inlet = 1, outlet_left = 2, outlet_right = 3, wall_patch = 4, outer_patch = 5;

void check(const VesselOptions& o) {
  const auto within = [](const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw InvalidArgument(fmt::format("vessel: {} is {}; give a number from {} to {}", name, value, low, high));
  };
  within("radius", o.radius, 1e-9, 1e9);
  within("trunk_length", o.trunk_length, 4 * o.radius, 1000 * o.radius);
  for (const double length : o.branch_lengths) within("branch_lengths", length, 6 * o.radius, 1000 * o.radius);
  within("branch_radius", o.branch_radius, 0.7, 0.85);
  within("branch_angle", o.branch_angle, 0.4, 0.8);
  within("out_of_plane", o.out_of_plane, 0.0, 0.7);
  within("tissue_thickness", o.tissue_thickness, 0.2 * o.radius, 0.8 * o.radius);
  within("core", o.core, 2, 64);
  within("rings", o.rings, 1, 32);
  within("tissue_layers", o.tissue_layers, 1, 32);
  within("step_length", o.step_length, 0.02 * o.radius, 0.5 * o.radius);
  within("peak_speed", o.peak_speed, -1e9, 1e9);
}

// From 0 to 1 over [0, 1], with slope 0 at both ends.
double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

// From -90 degrees at the first place of the half circle to 90 degrees at its last.
SineCosine on_arc(const VesselSection& section, std::uint32_t place) {
  return sine_cosine_of_turns(0.5 * (static_cast<double>(place) / section.arc - 0.5));
}

// Data of a section's point. Points between others mix their data, so that all of it varies smoothly.
struct Node {
  Vec3 position;
  Vec3 from_centre;
  double path = 0.0;
};

Node mix(const Node& a, const Node& b, double t) {
  const auto lerp = [t](const auto& x, const auto& y) { return x * (1 - t) + y * t; };
  return {lerp(a.position, b.position), lerp(a.from_centre, b.from_centre), lerp(a.path, b.path)};
}

// A section of one half: its plane, its lumen's boundary in that plane, and the flow through it.
struct Slice {
  Vec3 origin, u, v, t;            // u away from the other half, v to its left seen from downstream, t downstream
  double centre = 0.0;             // the centre line's place on u
  double path = 0.0;               // its length from the inlet
  double reach = 0.0;              // how far along -u the tissue between the halves goes
  std::vector<Point2> wall = {};   // places around the lumen
  std::vector<double> speed = {};  // along t, at the lumen's vertices

  [[nodiscard]] Node node(const Point2& p) const {
    return {origin + u * p[0] + v * p[1], u * (p[0] - centre) + v * p[1], path};
  }
};

// Slices of one half from the inlet to its outlet, in its own axes. The right half stays as it is, the left half is
// turned by half a turn about z.
class VesselHalf {
 public:
  VesselHalf(const VesselOptions& options, const VesselSection& section, std::size_t side)
      : o_(options), section_(section), length_(options.branch_lengths[side]) {
    trunk_steps_ = static_cast<std::size_t>(std::lround(o_.trunk_length / o_.step_length));
    const auto branch_steps = static_cast<std::size_t>(std::lround(length_ / o_.step_length));
    spread_disc();
    add_trunk(side == 0 ? -o_.out_of_plane : o_.out_of_plane);
    add_branch(branch_steps);
    if (side == 0) {
      for (Slice& s : slices_) {
        for (Vec3* a : {&s.origin, &s.u, &s.v, &s.t}) *a = {-a->x, -a->y, a->z};
      }
    }
  }

  [[nodiscard]] const std::vector<Slice>& slices() const { return slices_; }
  [[nodiscard]] std::size_t carina() const { return trunk_steps_; }

  // The last slice with tissue that reaches the tissue of the other half.
  [[nodiscard]] std::size_t last_joined() const { return last_joined_; }

 private:
  // The length over which a half disc becomes round and turns to its branch's direction, in radii.
  static constexpr double turn_length = 4.0;
  // The length over which the trunk widens towards the carina, in radii.
  static constexpr double widening_length = 1.5;

  // How steeply the branches part at the carina: the angle between the plane between them and each inner wall.
  [[nodiscard]] double parting_angle() const { return std::min(0.26, 0.5 * o_.branch_angle); }

  void spread_disc() {
    std::vector<Point2> circle;
    for (std::uint32_t b = 0; b < section_.around; ++b) circle.push_back(on_circle(b));
    for (const Point2& p : section_.spread(circle)) round_profile_.push_back(1 - p[0] * p[0] - p[1] * p[1]);
  }

  [[nodiscard]] Point2 on_circle(std::uint32_t place) const {
    const SineCosine turned = sine_cosine_of_turns((place - 0.5 * section_.arc) / section_.around);
    return {turned.cosine, turned.sine};
  }

  // Half an ellipse with its flat side on u = 0.
  [[nodiscard]] std::vector<Point2> half_ellipse(double width) const {
    std::vector<Point2> wall;
    for (std::uint32_t b = 0; b < section_.around; ++b) {
      const SineCosine turned = on_arc(section_, b);
      const double down = 1 - 2 * (static_cast<double>(b) - section_.arc) / section_.flat;
      const bool curved = b < section_.arc;
      wall.push_back({curved && b > 0 ? width * turned.cosine : 0.0, o_.radius * (curved ? turned.sine : down)});
    }
    return wall;
  }

  [[nodiscard]] double width_at(double path_to_carina) const {
    const double x = std::max(0.0, widening_length * o_.radius - path_to_carina);
    const SineCosine parting = sine_cosine(parting_angle());
    return o_.radius + 0.5 * (parting.sine / parting.cosine) * x * x / (widening_length * o_.radius);
  }

  // The trunk's axis turns by `bend` in these axes: opposite in those of the two halves, as their v is.
  void add_trunk(double bend) {
    const double length = o_.step_length * static_cast<double>(trunk_steps_);
    const auto turned = [&](double to_carina) { return bend * smooth(to_carina / length); };
    Vec3 origin;
    for (std::size_t i = 0; i <= trunk_steps_; ++i) {
      const double to_carina = o_.step_length * static_cast<double>(i);
      const SineCosine at = sine_cosine(turned(to_carina));
      Slice s{origin, {1, 0, 0}, {0, at.cosine, -at.sine}, {0, at.sine, at.cosine}};
      s.path = length - to_carina;
      s.wall = half_ellipse(width_at(to_carina));
      add_flow(s, smooth(1 - to_carina / (widening_length * o_.radius)));
      slices_.push_back(std::move(s));
      const SineCosine between = sine_cosine(turned(to_carina + 0.5 * o_.step_length));
      origin -= Vec3{0, between.sine, between.cosine} * o_.step_length;
    }
    std::reverse(slices_.begin(), slices_.end());
  }

  void add_branch(std::size_t steps) {
    const double turn = turn_length * o_.radius, width = width_at(0.0), start = 0.5 * width,
                 trunk = slices_.back().path;
    const std::vector<Point2> half = half_ellipse(width);
    // The centre line parts at once, so that the wedge between the branches has an angle; the sections turn smoothly.
    const auto sideways = [&](double s) {
      return parting_angle() + (o_.branch_angle - parting_angle()) * smooth(s / turn);
    };
    const auto out = [&](double s) { return o_.out_of_plane * smooth((s - turn) / (length_ - turn)); };
    const auto direction = [](double aside, double out_of_plane) {
      const SineCosine a = sine_cosine(aside);
      const SineCosine b = sine_cosine(out_of_plane);
      return Vec3{a.sine * b.cosine, b.sine, a.cosine * b.cosine};
    };
    Vec3 origin = {start, 0, 0};
    for (std::size_t i = 1; i <= steps; ++i) {
      const double s = o_.step_length * static_cast<double>(i), middle = s - 0.5 * o_.step_length;
      origin += direction(sideways(middle), out(middle)) * o_.step_length;
      const double tilt = o_.branch_angle * smooth(s / turn), round = smooth(s / turn);
      const SineCosine tilted = sine_cosine(tilt);
      Slice slice{origin, {tilted.cosine, 0, -tilted.sine}, {}, direction(tilt, out(s))};
      slice.v = cross(slice.t, slice.u);
      slice.centre = -start * (1 - round);
      slice.path = trunk + s;
      double inner = 0.0;
      for (std::uint32_t b = 0; b < section_.around; ++b) {
        const Point2 circle = on_circle(b);
        const double r = o_.branch_radius * o_.radius * round;
        slice.wall.push_back(
            {(1 - round) * (half[b][0] - start) + r * circle[0], (1 - round) * half[b][1] + r * circle[1]});
        inner = std::max(inner, -slice.wall.back()[0]);
      }
      const double to_other_half = origin.x / tilted.cosine;
      slice.reach = std::min(inner + o_.tissue_thickness, to_other_half);
      if (slice.reach == to_other_half) last_joined_ = slices_.size();
      add_flow(slice, 1.0);
      slices_.push_back(std::move(slice));
    }
  }

  // The profile: the ellipse's paraboloid in the trunk, mixed into one that is 0 all around the half. Scaled to the
  // same flux everywhere.
  void add_flow(Slice& s, double parted) const {
    const std::vector<Point2> places = section_.spread(s.wall);
    const double width = std::max_element(s.wall.begin(), s.wall.end())->at(0);
    for (std::uint32_t v = 0; v < section_.lumen_count; ++v) {
      const double x = places[v][0] / width, y = places[v][1] / o_.radius;
      s.speed.push_back(std::max(0.0, (1 - parted) * (1 - x * x - y * y) + parted * round_profile_[v]));
    }
    for (std::uint32_t b = 0; b < section_.around; ++b) {
      if (b <= section_.arc || parted == 1.0) s.speed[section_.wall(b)] = 0.0;
    }
    double flux = 0.0;
    for (const QuadCorners& q : section_.lumen) {
      const auto turn = [&](std::size_t i) {
        const Point2 &a = places[q[0]], &b = places[q[i]], &c = places[q[i + 1]];
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      };
      flux += 0.5 * (turn(1) + turn(2)) * 0.25 * (s.speed[q[0]] + s.speed[q[1]] + s.speed[q[2]] + s.speed[q[3]]);
    }
    const double wanted = o_.peak_speed * 0.25 * pi * o_.radius * o_.radius;  // half of a paraboloid over a disc
    for (double& speed : s.speed) speed *= wanted / flux;
  }

  const VesselOptions& o_;
  const VesselSection& section_;
  double length_;
  std::size_t trunk_steps_ = 0;
  std::size_t last_joined_ = 0;
  std::vector<double> round_profile_;
  std::vector<Slice> slices_;
};

using Ids = std::vector<std::uint32_t>;

class VesselBuilder {
 public:
  explicit VesselBuilder(const VesselOptions& options)
      : o_(options),
        section_(options.core, options.rings, options.tissue_layers),
        halves_{VesselHalf(options, section_, 0), VesselHalf(options, section_, 1)} {}

  MeshData build() {
    add_points();
    const std::size_t carina = halves_[0].carina();
    for (std::size_t i = 0; i < carina; ++i) {
      for (std::size_t side = 0; side < 2; ++side) add_step(side, i);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t i = carina; i + 1 < ids_[side].size(); ++i) add_step(side, i);
    }
    name_patches();
    add_point_data();
    mesh_.region_names = {{lumen_region, "lumen"}, {tissue_region, "tissue"}};
    for (const std::int32_t region : mesh_.regions) mesh_.free.push_back(region == lumen_region ? 1 : 0);
    return std::move(mesh_);
  }

 private:
  // All points of a slice but those between the columns' ends, which depend on the other half.
  [[nodiscard]] std::vector<Node> slice_nodes(const Slice& s) const {
    std::vector<Node> nodes(section_.vertex_count);
    const std::vector<Point2> lumen = section_.spread(s.wall);
    for (std::uint32_t v = 0; v < section_.lumen_count; ++v) nodes[v] = s.node(lumen[v]);
    const auto over_wall = [&](std::uint32_t layer, std::uint32_t place) {
      const SineCosine turned = on_arc(section_, place);
      const double height = o_.tissue_thickness * layer / section_.layers;
      const bool end = place == 0 || place == section_.arc;
      return Point2{s.wall[place][0] + (end ? 0.0 : height * turned.cosine), s.wall[place][1] + height * turned.sine};
    };
    for (std::uint32_t l = 1; l <= section_.layers; ++l) {
      for (std::uint32_t k = 0; k <= section_.arc; ++k) nodes[section_.over_arc(l, k)] = s.node(over_wall(l, k));
    }
    for (std::uint32_t j = 0; j < section_.line.size(); ++j) {
      const Vec3 from_origin = nodes[section_.line[j]].position - s.origin;
      nodes[section_.in_column(section_.layers, j)] = s.node({-s.reach, dot(from_origin, s.v)});
    }
    return nodes;
  }

  void fill_columns(std::vector<Node>& nodes) const {
    for (std::uint32_t c = 1; c < section_.layers; ++c) {
      for (std::uint32_t j = 0; j < section_.line.size(); ++j) {
        nodes[section_.in_column(c, j)] = mix(nodes[section_.line[j]], nodes[section_.in_column(section_.layers, j)],
                                              static_cast<double>(c) / section_.layers);
      }
    }
  }

  std::uint32_t add_point(const Node& node) {
    mesh_.points.push_back(node.position);
    nodes_.push_back(node);
    return static_cast<std::uint32_t>(mesh_.points.size() - 1);
  }

  // Numbers the points of a slice that have no number yet.
  void add_slice(std::size_t side, const std::vector<Node>& nodes, Ids ids) {
    for (std::uint32_t v = 0; v < section_.vertex_count; ++v) {
      if (ids[v] == none) ids[v] = add_point(nodes[v]);
    }
    ids_[side].push_back(std::move(ids));
  }

  void add_points() {
    const auto last = static_cast<std::uint32_t>(section_.line.size() - 1);
    const std::size_t carina = halves_[0].carina();
    for (std::size_t i = 0; i <= carina; ++i) {
      // The halves share the line, which each of them runs along from its other end; the columns lie on it.
      Ids left(section_.vertex_count, none);
      Ids right(section_.vertex_count, none);
      const std::array<std::vector<Node>, 2> nodes = {slice_nodes(halves_[0].slices()[i]),
                                                      slice_nodes(halves_[1].slices()[i])};
      for (std::uint32_t j = 0; j <= last; ++j) {
        const std::uint32_t shared = add_point(nodes[0][section_.line[j]]);
        for (std::uint32_t c = 0; c <= section_.layers; ++c) {
          left[section_.in_column(c, j)] = right[section_.in_column(c, last - j)] = shared;
        }
      }
      add_slice(0, nodes[0], std::move(left));
      add_slice(1, nodes[1], std::move(right));
    }
    const std::size_t slices = std::max(halves_[0].slices().size(), halves_[1].slices().size());
    for (std::size_t i = carina + 1; i < slices; ++i) add_branch_slices(i);
  }

  void add_branch_slices(std::size_t i) {
    const auto last = static_cast<std::uint32_t>(section_.line.size() - 1);
    std::array<std::vector<Node>, 2> nodes;
    std::array<Ids, 2> ids = {Ids(section_.vertex_count, none), Ids(section_.vertex_count, none)};
    for (std::size_t side = 0; side < 2; ++side) {
      if (i < halves_[side].slices().size()) nodes[side] = slice_nodes(halves_[side].slices()[i]);
    }
    if (i <= halves_[0].last_joined()) {
      for (std::uint32_t j = 0; j <= last; ++j) {
        const std::uint32_t left = section_.in_column(section_.layers, j);
        const std::uint32_t right = section_.in_column(section_.layers, last - j);
        nodes[0][left] = nodes[1][right] = mix(nodes[0][left], nodes[1][right], 0.5);
        ids[0][left] = ids[1][right] = add_point(nodes[0][left]);
      }
    }
    for (std::size_t side = 0; side < 2; ++side) {
      if (nodes[side].empty()) continue;
      fill_columns(nodes[side]);
      add_slice(side, nodes[side], std::move(ids[side]));
    }
  }

  void add_cell(CellType type, std::initializer_list<std::uint32_t> corners, int region) {
    mesh_.add_cell(type, {corners.begin(), corners.size()});
    mesh_.regions.push_back(region);
  }

  // The cells between slice i and the next.
  void add_step(std::size_t side, std::size_t i) {
    const Ids &a = ids_[side][i], &b = ids_[side][i + 1];
    const std::size_t carina = halves_[side].carina();
    const auto hexahedron = [&](const QuadCorners& q, int region) {
      add_cell(CellType::hexahedron, {a[q[0]], a[q[1]], a[q[2]], a[q[3]], b[q[0]], b[q[1]], b[q[2]], b[q[3]]}, region);
    };
    for (const QuadCorners& q : section_.lumen) hexahedron(q, lumen_region);
    for (const QuadCorners& q : section_.tissue_arc) hexahedron(q, tissue_region);
    for (const QuadCorners& q : section_.tissue_columns) {
      if (i == carina) {
        add_cell(CellType::prism, {a[q[0]], b[q[0]], b[q[1]], a[q[3]], b[q[3]], b[q[2]]}, tissue_region);
      } else if (i > carina) {
        hexahedron(q, tissue_region);
      }
    }
    const std::uint32_t walls = i < carina ? section_.arc : section_.around;
    for (std::uint32_t k = 0; k < walls; ++k) {
      const std::uint32_t from = section_.wall(k), to = section_.wall(k + 1);
      mesh_.add_patch_face(std::array{a[from], a[to], b[to], b[from]}, wall_patch);
    }
  }

  void name_patches() {
    mesh_.patch_names = {{inlet, "inlet"},
                         {outlet_left, "outlet_left"},
                         {outlet_right, "outlet_right"},
                         {wall_patch, "wall"},
                         {outer_patch, "outer"}};
    for (std::size_t side = 0; side < 2; ++side) {
      const Ids &first = ids_[side].front(), &last = ids_[side].back();
      for (const QuadCorners& q : section_.lumen) {
        mesh_.add_patch_face(std::array{first[q[0]], first[q[3]], first[q[2]], first[q[1]]}, inlet);
        mesh_.add_patch_face(std::array{last[q[0]], last[q[1]], last[q[2]], last[q[3]]},
                             side == 0 ? outlet_left : outlet_right);
      }
    }
    const BoundaryFaces boundary = match_faces(mesh_).boundary;
    for (std::size_t f = 0; f < boundary.size(); ++f) {
      if (mesh_.regions[boundary.cells[f]] == tissue_region) mesh_.add_patch_face(boundary.face(f), outer_patch);
    }
  }

  void add_point_data() {
    DataArray velocity{"velocity", 3, std::vector<double>(3 * nodes_.size(), 0.0)};
    for (std::size_t side = 0; side < 2; ++side) {
      const std::vector<Ids>& ids = ids_[side];
      for (std::size_t i = 0; i < ids.size(); ++i) {
        const Slice& s = halves_[side].slices()[i];
        const Ids &before = ids[i == 0 ? 0 : i - 1], &after = ids[std::min(i + 1, ids.size() - 1)];
        for (std::uint32_t v = 0; v < section_.lumen_count; ++v) {
          // Along the line that the mesh draws through the point, so that neither wall nor widening is crossed.
          const Vec3 along = mesh_.points[after[v]] - mesh_.points[before[v]];
          const Vec3 w = along * (s.speed[v] / dot(along, s.t));
          std::copy_n(std::array{w.x, w.y, w.z}.begin(), 3,
                      velocity.values.begin() + 3 * static_cast<std::ptrdiff_t>(ids[i][v]));
        }
      }
    }
    DataArray direction{"pulse_direction", 3, {}}, path{"path_length", 1, {}};
    for (const Node& node : nodes_) {
      direction.values.insert(direction.values.end(), {node.from_centre.x, node.from_centre.y, node.from_centre.z});
      path.values.push_back(node.path);
    }
    mesh_.point_data = {std::move(velocity), std::move(direction), std::move(path)};
  }

  static constexpr std::uint32_t none = 0xffffffffU;

  const VesselOptions& o_;
  const VesselSection section_;
  const std::array<VesselHalf, 2> halves_;
  std::array<std::vector<Ids>, 2> ids_;  // the points of each half's slices
  std::vector<Node> nodes_;
  MeshData mesh_;
};

}  // namespace

MeshData generate_vessel(const VesselOptions& options) {
  check(options);
  return VesselBuilder(options).build();
}

}  // namespace dartcast
