// Binds dartcast/predicates.hpp. Signs are taken of single points, or of arrays of points at once.
#include "dartcast/predicates.hpp"

#include <algorithm>
#include <utility>

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::predicates {
namespace {

using Place = Typed<"Vector or Points">;

// One result, or an array of them.
template <class Result, class Number>
struct Of : py::object {
  Of(py::object of) : object(std::move(of)) {}  // NOLINT(google-explicit-constructor): it is the same object
};

using Where = Typed<"Vector or Points">;
template <std::size_t>
using WhereOf = Where;

constexpr std::array<const char*, 4> point_names = {"a", "b", "c", "d"};

// Points in a call: one of them, or an array.
class PointArgument {
 public:
  PointArgument(const py::object& x, const char* name) {
    if (is_array(x, 2)) {
      many_ = vectors(x, name);
      is_one_ = false;
    } else {
      one_ = vector(x, name);
    }
  }
  [[nodiscard]] bool is_one() const { return is_one_; }
  [[nodiscard]] std::size_t size() const { return many_.size(); }
  const Vec3& operator[](std::size_t i) const { return is_one_ ? one_ : many_[i]; }

 private:
  Vec3 one_;
  std::span<const Vec3> many_;
  bool is_one_ = true;
};

// f of each row. Points that are given once are the same in all rows.
template <class Number, std::size_t N, class Function>
py::object for_points(const std::array<py::object, N>& given, const Function& f) {
  std::vector<PointArgument> points;
  bool all_one = true;
  std::size_t rows = 0;
  for (std::size_t i = 0; i < N; ++i) {
    points.emplace_back(given[i], point_names[i]);
    if (points[i].is_one()) continue;
    if (!all_one && points[i].size() != rows) {
      throw InvalidArgument(std::string(point_names[i]) + ": expected " + std::to_string(rows) +
                            " points, as in the arrays before it; got " + std::to_string(points[i].size()));
    }
    rows = points[i].size();
    all_one = false;
  }
  const auto at = [&](std::size_t row) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) { return f(points[I][row]...); }
    (std::make_index_sequence<N>());
  };
  if (all_one) return py::cast(at(0));
  py::array_t<Number> values(static_cast<py::ssize_t>(rows));
  Number* value = values.mutable_data();
  const py::gil_scoped_release release;
  for (std::size_t i = 0; i < rows; ++i) value[i] = static_cast<Number>(at(i));
  return values;
}

// f of N points: a number, or one for each row.
template <class Number, class Result, std::size_t N, class F>
void bind_of(py::module_& m, const char* name, const F& f, const char* more) {
  static constexpr std::array<Argument, 4> arguments = {{{"a"}, {"b"}, {"c"}, {"d"}}};
  const About said = {about(name, more).text, std::span(arguments).first(N)};
  [&]<std::size_t... I>(std::index_sequence<I...> /*points*/) {
    m.def(
        name,
        [f](const WhereOf<I>&... points) -> Either<Result, py::array_t<Number>> {
          return for_points<Number, N>({points...}, f);
        },
        said);
  }
  (std::make_index_sequence<N>());
}

void bind_signs(py::module_& m) {
  constexpr const char* signs =
      "Each point is three numbers, or all of them are arrays (n, 3), where single points count for all rows. Returns "
      "a Sign, or int8 (n,).";
  constexpr const char* values =
      "Each point is three numbers, or all of them are arrays (n, 3), where single points count for all rows. Returns "
      "a number, or float64 (n,).";
  bind_of<std::int8_t, Sign, 4>(
      m, "orient3d", [](auto&... p) { return orient3d(p...); }, signs);
  bind_of<std::int8_t, Sign, 4>(
      m, "orient3d_exact", [](auto&... p) { return orient3d_exact(p...); }, signs);
  bind_of<double, double, 4>(
      m, "orient3d_value", [](auto&... p) { return orient3d_value(p...); }, values);
  bind_of<std::int8_t, Sign, 3>(
      m, "orient2d", [](auto&... p) { return orient2d(p...); }, signs);
  bind_of<std::int8_t, Sign, 3>(
      m, "orient2d_exact", [](auto&... p) { return orient2d_exact(p...); }, signs);
  bind_of<double, double, 3>(
      m, "orient2d_value", [](auto&... p) { return orient2d_value(p...); }, values);
}

void bind_bounds(py::module_& m) {
  m.def(
      "extent_of",
      [](const Typed<"Points">& x) {
        const auto all = vectors(x, "vectors");
        if (all.empty()) throw InvalidArgument("vectors: expected at least one");
        Vec3 extent;
        for (const Vec3& v : all) extent = extent_of(extent, v);
        return extent;
      },
      py::arg("vectors"), about("extent_of", "vectors: float64 (n, 3)."));
  m.def(
      "rounds_nothing",
      [](const Vec3& extent, const Typed<"Points">& x) {
        const auto all = vectors(x, "points");
        return std::all_of(all.begin(), all.end(), [&](const Vec3& p) { return rounds_nothing(extent, p); });
      },
      about("rounds_nothing", "points: float64 (n, 3)."));
}

void bind_ranges(py::module_& m) {
  m.def(
      "in_exact_range",
      [](const Where& p) -> Either<bool, py::array_t<bool>> {
        return for_points<bool, 1>({p}, [](const Vec3& x) { return in_exact_range(x); });
      },
      about("in_exact_range", "Of an array (n, 3): bool (n,)."));
  m.def(
      "flushed",
      [](const Typed<"Vector | Points">& x) {
        const PointArgument points(x, "x");
        if (points.is_one()) return array_of(flushed(points[0]));
        std::vector<Vec3> all(points.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = flushed(points[i]);
        return array_of(std::span<const Vec3>(all));
      },
      about("flushed", "x: three numbers, or an array (n, 3)."));
}

void expect_range(std::initializer_list<Vec3> points) {
  if (!std::all_of(points.begin(), points.end(), in_exact_range))
    throw InvalidArgument("a point is not finite, or has a coordinate above 2^300 in magnitude");
}

template <class Perturbation>
Perturbation perturbation(const Vec3& p, const py::object& opposite, std::size_t most) {
  const auto points = vectors(opposite, "opposite");
  if (points.size() > most)
    throw InvalidArgument("opposite: expected at most " + std::to_string(most) + " points; got " +
                          std::to_string(points.size()));
  expect_range({p});
  for (const Vec3& x : points) expect_range({x});
  return Perturbation(p, points);
}

void bind_perturbations(py::module_& m) {
  py::class_<SymbolicPerturbation>(m, "SymbolicPerturbation", doc("SymbolicPerturbation"))
      .def(py::init([](const Vec3& p, const Typed<"Points">& opposite) {
             return perturbation<SymbolicPerturbation>(p, opposite, 3);
           }),
           about("SymbolicPerturbation::SymbolicPerturbation"))
      .def(
          "of_line",
          [](const SymbolicPerturbation& s, const Vec3& a, const Vec3& b, const Vec3& q) {
            expect_range({a, b, q});
            return s.of_line(a, b, q);
          },
          about("SymbolicPerturbation::of_line"));
  py::class_<PlanarSymbolicPerturbation>(m, "PlanarSymbolicPerturbation", doc("PlanarSymbolicPerturbation"))
      .def(py::init([](const Vec3& p, const Typed<"Points">& opposite) {
             return perturbation<PlanarSymbolicPerturbation>(p, opposite, 2);
           }),
           about("PlanarSymbolicPerturbation::PlanarSymbolicPerturbation"))
      .def(
          "of_line",
          [](const PlanarSymbolicPerturbation& s, const Vec3& q0) {
            expect_range({q0});
            return s.of_line(q0);
          },
          about("PlanarSymbolicPerturbation::of_line"));
}

}  // namespace

void bind(py::module_& m) {
  bind_signs(m);
  bind_bounds(m);
  bind_ranges(m);
  bind_perturbations(m);
}

}  // namespace dartcast::python::predicates
